"""A folder of photographs, described by its file capture.toml."""

import tomllib
from pathlib import Path

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.inverse.photographs.capture.cameras import (
    cameras_of_file,
    require_known,
    to_number,
    to_numbers,
)
from brdfkit.inverse.photographs.capture.capture import Capture
from brdfkit.mitsuba_bridge.properties.picture_file import read_photograph

NAME = "capture.toml"
AT_CAMERA = "camera"  # the place of a flash light


def load_capture(folder, accept_8_bit=False):
    """The `Capture` of a `folder`; see docs/how_to/photographs.md for its file.

    Raises `BrdfkitError` for what is missing, misspelt or of the wrong form, for pictures of
    different sizes, and for pictures of 8 bits, unless `accept_8_bit`: then sRGB's curve is
    inverted.
    """
    folder = Path(folder)
    path = folder / NAME
    said = _tables(folder, path)
    sample = said.get("sample", {})
    require_known(path, sample, ("width", "height"), "[sample]")
    size = tuple(to_number(path, sample, side, "[sample]") for side in ("width", "height"))
    if min(size) <= 0:
        raise BrdfkitError(f"{path}: the sample's width and height should be above 0 [m].")
    lights = _lights(path, said)
    positions, intensities = _places(path, lights)
    names = tuple(light["picture"] for light in lights)
    pictures = _pictures(folder, names, accept_8_bit)
    cameras = cameras_of_file(path, said, size, pictures.shape[2:0:-1])
    positions = [
        own.origin if place is None else place
        for own, place in zip(cameras, positions, strict=True)
    ]
    return Capture(pictures, np.array(positions), np.array(intensities), cameras, size, names)


def _tables(folder, path):
    """The tables of the file, whose names are known."""
    if not folder.is_dir():
        raise BrdfkitError(f"{folder}: there is no such folder; check the path.")
    if not path.is_file():
        raise BrdfkitError(f"{folder}: there is no {NAME} in it, which says where the lights are.")
    try:
        said = tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except ValueError as error:  # that it is no TOML, no UTF-8, or has a number too long
        raise BrdfkitError(f"{path}: it is no TOML ({error}).") from error
    require_known(path, said, ("sample", "camera", "light"), "the file")
    return said


def _lights(path, said):
    """The tables of the lights, each with a picture."""
    lights = said.get("light")
    if not isinstance(lights, list) or not lights:
        raise BrdfkitError(f"{path}: it names no [[light]]; there should be one for each picture.")
    for number, light in enumerate(lights, 1):
        known = "picture", "position", "intensity", "camera"
        require_known(path, light, known, f"[[light]] {number}")
        if not isinstance(light.get("picture"), str):
            raise BrdfkitError(f"{path}: [[light]] {number} names no picture.")
        if light["picture"] in (other["picture"] for other in lights[: number - 1]):
            raise BrdfkitError(f"{path}: {light['picture']} is named twice; each has one light.")
    return lights


def _places(path, lights):
    """(positions, intensities) of the lights, lists of arrays (3,); a flash has no position."""
    positions, intensities = [], []
    for light in lights:
        name, place = light["picture"], light.get("position")
        flash = place == AT_CAMERA
        positions.append(None if flash else to_numbers(path, place, f"{name}: position", 3))
        power = light.get("intensity", 1.0)
        power = power if isinstance(power, list) else [power] * 3
        intensities.append(to_numbers(path, power, f"{name}: intensity", 3))
    return positions, intensities


def _pictures(folder, names, accept_8_bit):
    """Pictures (lights, height, width, 3) by their names."""
    pictures = [read_photograph(folder / name, accept_8_bit) for name in names]
    for name, picture in zip(names, pictures, strict=True):
        if picture.shape != pictures[0].shape:
            own, first = (f"{p.shape[1]} × {p.shape[0]}" for p in (picture, pictures[0]))
            raise BrdfkitError(
                f"{folder / name}: it has {own} pixels, and {names[0]} {first}; they should "
                "be alike."
            )
    return np.array(pictures)
