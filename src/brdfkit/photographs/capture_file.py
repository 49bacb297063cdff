"""A folder of photographs, described by its file capture.toml."""

import tomllib
from pathlib import Path

import numpy as np

from brdfkit.errors import BrdfkitError
from brdfkit.host.picture_file import read_photograph
from brdfkit.photographs.capture import Capture
from brdfkit.photographs.pinhole import Pinhole

NAME = "capture.toml"
AT_CAMERA = "camera"  # the place of a flash light


def load_capture(folder, linearise=False):
    """The `Capture` of a `folder`; see docs/how_to/photographs.md for its file.

    Raises `BrdfkitError` for what is missing, misspelt or of the wrong form, for pictures of
    different sizes, and for pictures of 8 bits, unless it is to `linearise` by sRGB's curve.
    """
    folder = Path(folder)
    path = folder / NAME
    if not folder.is_dir():
        raise BrdfkitError(f"{folder}: there is no such folder; check the path.")
    if not path.is_file():
        raise BrdfkitError(f"{folder}: there is no {NAME} in it, which says where the lights are.")
    try:
        said = tomllib.loads(path.read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise BrdfkitError(f"{path}: it is no TOML ({error}).") from error
    _require_known(path, said, ("sample", "camera", "light"), "the file")
    size = tuple(_number(path, said, "sample", side) for side in ("width", "height"))
    if min(size) <= 0:
        raise BrdfkitError(f"{path}: the sample's width and height should be above 0 [m].")
    camera = _camera(path, said)
    lights = said.get("light")
    if not isinstance(lights, list) or not lights:
        raise BrdfkitError(f"{path}: it names no [[light]]; there should be one for each picture.")
    positions, intensities, names = [], [], []
    for number, light in enumerate(lights):
        where = f"light {number}"
        _require_known(path, light, ("picture", "position", "intensity"), where)
        name = light.get("picture")
        if not isinstance(name, str):
            raise BrdfkitError(f"{path}: {where} names no picture.")
        place = light.get("position")
        flash = place == AT_CAMERA
        positions.append(camera.origin if flash else _numbers(path, place, f"{where}: position", 3))
        intensities.append(_numbers(path, light.get("intensity", 1.0), f"{where}: intensity", 3))
        names.append(name)
    pictures = [read_photograph(folder / name, linearise) for name in names]
    for name, picture in zip(names, pictures, strict=True):
        if picture.shape != pictures[0].shape:
            own, first = (f"{p.shape[1]} × {p.shape[0]}" for p in (picture, pictures[0]))
            raise BrdfkitError(
                f"{folder / name}: it has {own} pixels, and {names[0]} {first}: the camera should "
                "rest."
            )
    arrays = (np.array(all_of, float) for all_of in (pictures, positions, intensities))
    return Capture(*arrays, camera, size, tuple(names))


def _camera(path, said):
    _require_known(path, said.get("camera", {}), ("origin", "target", "up", "fov"), "[camera]")
    given = said.get("camera", {})
    vectors = [
        _numbers(path, given.get(name, usual), f"[camera] {name}", 3)
        for name, usual in (("origin", None), ("target", [0, 0, 0]), ("up", [0, 1, 0]))
    ]
    fov = _number(path, said, "camera", "fov")
    if not 0 < fov < 180:
        raise BrdfkitError(f"{path}: [camera] fov = {fov:g} should be between 0 and 180 degrees.")
    camera = Pinhole(*vectors, fov)
    if not np.isfinite(camera.axes).all():
        raise BrdfkitError(f"{path}: [camera] looks along up, or at where it is.")
    return camera


def _number(path, said, table, name):
    value = said.get(table, {}).get(name)
    if isinstance(value, bool) or not isinstance(value, int | float) or not np.isfinite(value):
        raise BrdfkitError(f"{path}: [{table}] {name} = {value!r} should be a number.")
    return float(value)


def _numbers(path, value, what, count):
    """An array (count,) of a list of numbers, or of one number for all."""
    try:
        found = np.broadcast_to(np.asarray(value, float), (count,)).astype(float)
    except (TypeError, ValueError):
        found = np.array([np.nan])
    if not np.isfinite(found).all():
        raise BrdfkitError(f"{path}: {what} = {value!r} should be {count} numbers.")
    return found


def _require_known(path, table, known, where):
    for name in table:
        if name not in known:
            raise BrdfkitError(
                f"{path}: {where} has {name!r}, which is not known; known are {', '.join(known)}."
            )
