"""The cameras that a file capture.toml names: one for all pictures, or one for each."""

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.inverse.photographs.capture.camera_from_corners import camera_from_corners
from brdfkit.inverse.photographs.capture.pinhole import Pinhole, corners_of

LARGEST = 1e30  # of a number: squares of lengths, and their sums, stay finite


def to_number(path, table, name, where):
    """The number `name` of a table."""
    value = table.get(name)
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) < LARGEST:
        raise BrdfkitError(f"{path}: {where} {name} = {value!r} should be a number below 1e30.")
    return float(value)


def to_numbers(path, value, what, shape):
    """An array of a `shape`, of lists of numbers."""
    shape = tuple(np.atleast_1d(shape))
    try:
        found = np.array(value)
    except ValueError:
        found = np.array("lists of different lengths")
    numbers = found.shape == shape and found.dtype.kind in "if"
    if not numbers or not (np.abs(found.astype(float)) < LARGEST).all():
        count = " × ".join(map(str, shape))
        raise BrdfkitError(f"{path}: {what} = {value!r} should be {count} numbers below 1e30.")
    return found.astype(float)


def require_known(path, table, known, where):
    """Raise `BrdfkitError` unless this is a table, whose entries are `known`."""
    if not isinstance(table, dict):
        raise BrdfkitError(f"{path}: {where} should be a table, of {', '.join(known)}.")
    for name in table:
        if name not in known:
            raise BrdfkitError(
                f"{path}: {where} has {name!r}, which is not known; known are {', '.join(known)}."
            )


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
