"""Reads a folder of photographs with the file capture.toml, which describes cameras and lights."""

from pathlib import Path
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.inverse.photographs.capture.camera_from_corners import find_camera
from brdfkit.inverse.photographs.capture.capture import Capture
from brdfkit.inverse.photographs.capture.pictures.coding import Coding
from brdfkit.inverse.photographs.capture.pictures.photograph_file import read_linear
from brdfkit.inverse.photographs.capture.pictures.raw_file import require_raw_reader
from brdfkit.inverse.photographs.capture.pinhole import Pinhole, find_corners
from brdfkit.inverse.photographs.capture.toml_entries import (
    AT_CAMERA,
    NAME,
    check_keys,
    read_intensity,
    read_lights,
    read_number,
    read_numbers,
    read_tables,
)

CAMERA_KEYS = "origin", "target", "up", "fov", "corners"
POSITION_KEYS = "origin", "corners"  # keys of a camera in the file; one of the two says where it is
LIGHT_KEYS = "picture", "position", "intensity", "camera"


def load_capture(folder: str | Path, coding: Coding | None = None) -> Capture:
    """Return the `Capture` in a folder; docs/how_to/photographs.md describes the file capture.toml.

    `coding` tells how the numbers of photographs are coded.
    Raises `BrdfkitError` for entries that are missing, misspelt or wrong, for pictures of different
    sizes, and for pictures of 8 bits of unknown coding.
    """
    folder = Path(folder)
    path = folder / NAME
    tables = read_tables(folder)
    sample = tables.get("sample", {})
    check_keys(path, sample, ("width", "height"), "[sample]")
    width, height = (
        read_number(f"{path}: [sample] {side}", sample.get(side)) for side in ("width", "height")
    )
    if min(width, height) <= 0:
        raise BrdfkitError(f"{path}: the sample's width and height should be above 0 [m].")
    lights = read_lights(path, tables, LIGHT_KEYS)
    positions, intensities = _read_positions(path, lights)
    names = tuple(light["picture"] for light in lights)
    pictures = _read_pictures(folder, names, coding)
    size, picture_size = (width, height), (pictures.shape[2], pictures.shape[1])
    cameras = _read_cameras(path, tables, size, picture_size)
    places = [
        camera.origin if position is None else position
        for camera, position in zip(cameras, positions, strict=True)
    ]
    return Capture(pictures, np.array(places), np.array(intensities), cameras, size, names)


def _read_positions(
    path: Path, lights: list[dict[str, Any]]
) -> tuple[list[FloatArray | None], list[FloatArray]]:
    """Return the positions and intensities (3,) of the lights; the position of a flash is None."""
    positions: list[FloatArray | None] = []
    intensities = []
    for light in lights:
        what, position = f"{path}: {light['picture']}:", light.get("position")
        flash = position == AT_CAMERA
        positions.append(None if flash else read_numbers(f"{what} position", position, (3,)))
        intensities.append(read_intensity(what, light))
    return positions, intensities


def _read_pictures(folder: Path, names: tuple[str, ...], coding: Coding | None) -> FloatArray:
    """Return the pictures (lights, height, width, 3) with the given file names in a folder."""
    require_raw_reader([folder / name for name in names])
    pictures = [read_linear(folder / name, coding)[0] for name in names]
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
    check_keys(path, common, CAMERA_KEYS, "[camera]")
    if not any("camera" in light for light in lights):
        return (_make_camera(path, common, "[camera]", size, picture_size),) * len(lights)
    cameras = []
    for light in lights:
        own, where = light.get("camera", {}), f"{light['picture']}: camera"
        check_keys(path, own, CAMERA_KEYS, where)
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
    fov = read_number(f"{what} fov", table.get("fov"))
    if "corners" in table:
        if "origin" in table:
            raise BrdfkitError(f"{what} has an origin and corners; one of them is enough.")
        places = read_numbers(f"{what} corners", table["corners"], (4, 2))
        try:
            return find_camera(places, find_corners(size), picture_size, fov)
        except BrdfkitError as error:
            raise BrdfkitError(f"{what} corners: {error}") from None
    defaults = {"origin": None, "target": [0, 0, 0], "up": [0, 1, 0]}
    origin, target, up = (
        read_numbers(f"{what} {name}", table.get(name, default), (3,))
        for name, default in defaults.items()
    )
    try:
        return Pinhole(origin, target, up, fov)
    except BrdfkitError as error:
        raise BrdfkitError(f"{what}: {error}") from None
