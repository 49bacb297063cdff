"""Reads a folder of photographs with the file capture.toml, which describes cameras and lights."""

import tomllib
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from brdfkit.core.arguments import to_number, wrong_value_error
from brdfkit.core.array_types import AnyArray, FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.inverse.photographs.capture.camera_from_corners import find_camera
from brdfkit.inverse.photographs.capture.capture import Capture
from brdfkit.inverse.photographs.capture.pinhole import Pinhole, find_corners
from brdfkit.mitsuba_bridge.properties.picture_file import read_photograph

NAME = "capture.toml"
AT_CAMERA = "camera"  # value of the key `position` for a flash, which is at the camera
CAMERA_KEYS = "origin", "target", "up", "fov", "corners"
POSITION_KEYS = "origin", "corners"  # keys of a camera in the file; one of the two says where it is
LARGEST_NUMBER = 1e30  # largest number in the file; squares of larger ones could overflow


def load_capture(folder: str | Path, accept_8_bit: bool = False) -> Capture:
    """Return the `Capture` in a folder; docs/how_to/photographs.md describes the file capture.toml.

    Raises `BrdfkitError` for entries that are missing, misspelt or wrong, for pictures of different
    sizes, and for pictures of 8 bits unless `accept_8_bit`; the sRGB curve of those is inverted.
    """
    folder = Path(folder)
    path = folder / NAME
    tables = _read_tables(folder, path)
    sample = tables.get("sample", {})
    _check_keys(path, sample, ("width", "height"), "[sample]")
    width, height = (
        _read_number(f"{path}: [sample] {side}", sample.get(side)) for side in ("width", "height")
    )
    if min(width, height) <= 0:
        raise BrdfkitError(f"{path}: the sample's width and height should be above 0 [m].")
    lights = _read_lights(path, tables)
    positions, intensities = _read_positions(path, lights)
    names = tuple(light["picture"] for light in lights)
    pictures = _read_pictures(folder, names, accept_8_bit)
    size, picture_size = (width, height), (pictures.shape[2], pictures.shape[1])
    cameras = _read_cameras(path, tables, size, picture_size)
    places = [
        camera.origin if position is None else position
        for camera, position in zip(cameras, positions, strict=True)
    ]
    return Capture(pictures, np.array(places), np.array(intensities), cameras, size, names)


def _read_tables(folder: Path, path: Path) -> dict[str, Any]:
    """Return the top-level tables of a folder's file capture.toml, whose names are checked."""
    if not folder.is_dir():
        raise BrdfkitError(f"{folder}: there is no such folder; check the path.")
    if not path.is_file():
        raise BrdfkitError(f"{folder}: there is no {NAME} in it, which says where the lights are.")
    try:
        tables = tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except ValueError as error:  # no TOML, no UTF-8, or a number with too many digits
        raise BrdfkitError(f"{path}: it is no TOML ({error}).") from error
    _check_keys(path, tables, ("sample", "camera", "light"), "the file")
    return tables


def _read_lights(path: Path, tables: dict[str, Any]) -> list[dict[str, Any]]:
    """Return the tables `[[light]]` of the file capture.toml, one for each picture.

    Raises `BrdfkitError` unless each of them names a picture that no other one names.
    """
    lights = tables.get("light")
    if not isinstance(lights, list) or not lights:
        raise BrdfkitError(f"{path}: it names no [[light]]; there should be one for each picture.")
    for number, light in enumerate(lights, 1):
        known = "picture", "position", "intensity", "camera"
        _check_keys(path, light, known, f"[[light]] {number}")
        if not isinstance(light.get("picture"), str):
            raise BrdfkitError(f"{path}: [[light]] {number} names no picture.")
        if light["picture"] in (other["picture"] for other in lights[: number - 1]):
            raise BrdfkitError(f"{path}: {light['picture']} is named twice; each has one light.")
    return lights


def _read_positions(
    path: Path, lights: list[dict[str, Any]]
) -> tuple[list[FloatArray | None], list[FloatArray]]:
    """Return the positions and intensities (3,) of the lights; the position of a flash is None."""
    positions: list[FloatArray | None] = []
    intensities = []
    for light in lights:
        what, position = f"{path}: {light['picture']}:", light.get("position")
        flash = position == AT_CAMERA
        positions.append(None if flash else _read_numbers(f"{what} position", position, (3,)))
        power = light.get("intensity", 1.0)
        power = power if isinstance(power, list) else [power] * 3
        intensities.append(_read_numbers(f"{what} intensity", power, (3,)))
    return positions, intensities


def _read_pictures(folder: Path, names: tuple[str, ...], accept_8_bit: bool) -> FloatArray:
    """Return the pictures (lights, height, width, 3) with the given file names in a folder."""
    pictures = [read_photograph(folder / name, accept_8_bit) for name in names]
    for name, picture in zip(names, pictures, strict=True):
        if picture.shape != pictures[0].shape:
            own, first = (f"{p.shape[1]} × {p.shape[0]}" for p in (picture, pictures[0]))
            raise BrdfkitError(
                f"{folder / name}: it has {own} pixels, and {names[0]} {first}; they should "
                "be alike."
            )
    return np.array(pictures)


def _read_cameras(
    path: Path, tables: dict[str, Any], size: tuple[float, float], picture_size: tuple[int, int]
) -> tuple[Pinhole, ...]:
    """Return the camera of each picture, from the table `[camera]` and those in the lights' tables.

    A light's table `camera` completes the common one, or replaces its position. `size` is the
    sample's width and height [m], and `picture_size` the pictures' width and height [pixels].
    """
    common, lights = tables.get("camera", {}), tables["light"]
    _check_keys(path, common, CAMERA_KEYS, "[camera]")
    if not any("camera" in light for light in lights):
        return (_make_camera(path, common, "[camera]", size, picture_size),) * len(lights)
    cameras = []
    for light in lights:
        own, where = light.get("camera", {}), f"{light['picture']}: camera"
        _check_keys(path, own, CAMERA_KEYS, where)
        moved = any(key in own for key in POSITION_KEYS)
        shared = {k: v for k, v in common.items() if not (moved and k in POSITION_KEYS)}
        cameras.append(_make_camera(path, shared | own, where, size, picture_size))
    return tuple(cameras)


def _make_camera(
    path: Path,
    table: dict[str, Any],
    where: str,
    size: tuple[float, float],
    picture_size: tuple[int, int],
) -> Pinhole:
    """Return the camera that a table describes by its origin, or by the sample's corners.

    `path` and `where` name the table in errors; `size` is the sample's width and height [m].
    """
    what = f"{path}: {where}"
    fov = _read_number(f"{what} fov", table.get("fov"))
    if "corners" in table:
        if "origin" in table:
            raise BrdfkitError(f"{what} has an origin and corners; one of them is enough.")
        places = _read_numbers(f"{what} corners", table["corners"], (4, 2))
        try:
            return find_camera(places, find_corners(size), picture_size, fov)
        except BrdfkitError as error:
            raise BrdfkitError(f"{what} corners: {error}") from None
    defaults = {"origin": None, "target": [0, 0, 0], "up": [0, 1, 0]}
    origin, target, up = (
        _read_numbers(f"{what} {name}", table.get(name, default), (3,))
        for name, default in defaults.items()
    )
    try:
        return Pinhole(origin, target, up, fov)
    except BrdfkitError as error:
        raise BrdfkitError(f"{what}: {error}") from None


def _read_number(what: str, value: object) -> float:
    """Return an entry of capture.toml as a number; `what` names the entry in errors."""
    return to_number(what, value, -LARGEST_NUMBER, LARGEST_NUMBER)


def _read_numbers(what: str, value: object, shape: tuple[int, ...]) -> FloatArray:
    """Return nested lists of capture.toml as an array of a given shape.

    `what` names the entry in errors.
    """
    try:
        numbers: AnyArray = np.array(value)
    except ValueError:  # nested lists of different lengths make no array
        numbers = np.array("")
    if numbers.shape == shape and numbers.dtype.kind in "if":
        array: FloatArray = numbers.astype(float)
        if (np.abs(array) < LARGEST_NUMBER).all():
            return array
    raise wrong_value_error(what, value, f"{' × '.join(map(str, shape))} numbers below 1e30")


def _check_keys(path: Path, table: object, known: Iterable[str], where: str) -> None:
    """Raise `BrdfkitError` unless an entry of capture.toml is a table with `known` keys alone."""
    if not isinstance(table, dict):
        raise BrdfkitError(f"{path}: {where} should be a table, of {', '.join(known)}.")
    for name in table:
        if name not in known:
            raise BrdfkitError(
                f"{path}: {where} has {name!r}, which is not known; known are {', '.join(known)}."
            )
