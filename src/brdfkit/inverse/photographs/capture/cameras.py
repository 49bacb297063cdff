"""The cameras that a file capture.toml names: one for all pictures, or one for each."""

from brdfkit.core.errors import BrdfkitError
from brdfkit.inverse.photographs.capture.camera_from_corners import camera_from_corners
from brdfkit.inverse.photographs.capture.pinhole import Pinhole, corners_of
from brdfkit.inverse.photographs.capture.toml_values import require_known, to_number, to_numbers

KNOWN = "origin", "target", "up", "fov", "corners"
PLACE = "origin", "corners"  # what says where a camera was, one or the other


def cameras_of_file(path, said, size, picture_size):
    """The `Pinhole` of each light, a tuple, of the tables of a file.

    `said`: the file's tables; `size` of the sample [m]; `picture_size` (width, height) [pixels].
    A light's own table `camera` adds to the file's, or replaces its place.
    """
    common, lights = said.get("camera", {}), said["light"]
    require_known(path, common, KNOWN, "[camera]")
    if not any("camera" in light for light in lights):
        return (_camera(path, common, "[camera]", size, picture_size),) * len(lights)
    cameras = []
    for light in lights:
        own, where = light.get("camera", {}), f"{light['picture']}: camera"
        require_known(path, own, KNOWN, where)
        moved = "origin" in own or "corners" in own
        rest = {name: v for name, v in common.items() if not (moved and name in PLACE)}
        cameras.append(_camera(path, rest | own, where, size, picture_size))
    return tuple(cameras)


def _camera(path, table, where, size, picture_size):
    fov = to_number(path, table, "fov", where)
    if "corners" in table:
        return _by_corners(path, table, where, size, picture_size, fov)
    vectors = [
        to_numbers(path, table.get(name, usual), f"{where} {name}", 3)
        for name, usual in (("origin", None), ("target", [0, 0, 0]), ("up", [0, 1, 0]))
    ]
    try:
        return Pinhole(*vectors, fov)
    except BrdfkitError as error:
        raise BrdfkitError(f"{path}: {where}: {error}") from None


def _by_corners(path, table, where, size, picture_size, fov):
    if "origin" in table:
        raise BrdfkitError(f"{path}: {where} has an origin and corners; one of them is enough.")
    places = to_numbers(path, table["corners"], f"{where} corners", (4, 2))
    try:
        return camera_from_corners(places, corners_of(size), picture_size, fov)
    except BrdfkitError as error:
        raise BrdfkitError(f"{path}: {where} corners: {error}") from None
