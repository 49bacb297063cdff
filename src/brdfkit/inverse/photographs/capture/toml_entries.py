"""Reads the file capture.toml, and checks single entries of it."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from brdfkit.core.arguments import to_number, wrong_value_error
from brdfkit.core.array_types import AnyArray, FloatArray
from brdfkit.core.errors import BrdfkitError

NAME = "capture.toml"
AT_CAMERA = "camera"  # value of the key `position` for a flash, which is at the camera
LARGEST_NUMBER = 1e30  # largest number in the file; squares of larger ones could overflow
TABLES = "sample", "object", "camera", "light"


def read_tables(folder: Path) -> dict[str, Any]:
    """Return the top-level tables of a folder's file capture.toml, whose names are checked.

    Raises `BrdfkitError` for a missing folder or file, and for a file that is no TOML.
    """
    path = folder / NAME
    if not folder.is_dir():
        raise BrdfkitError(f"{folder}: there is no such folder; check the path.")
    if not path.is_file():
        raise BrdfkitError(f"{folder}: there is no {NAME} in it, which says where the lights are.")
    try:
        tables = tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except ValueError as error:  # no TOML, no UTF-8, or a number with too many digits
        raise BrdfkitError(f"{path}: it is no TOML ({error}).") from error
    check_keys(path, tables, TABLES, "the file")
    return tables


def read_lights(path: Path, tables: dict[str, Any], known: Iterable[str]) -> list[dict[str, Any]]:
    """Return the tables `[[light]]` of the file capture.toml, one for each picture.

    Raises `BrdfkitError` unless each of them has `known` keys alone, and names a picture that no
    other one names.
    """
    lights = tables.get("light")
    if not isinstance(lights, list) or not lights:
        raise BrdfkitError(f"{path}: it names no [[light]]; there should be one for each picture.")
    for number, light in enumerate(lights, 1):
        check_keys(path, light, known, f"[[light]] {number}")
        if not isinstance(light.get("picture"), str):
            raise BrdfkitError(f"{path}: [[light]] {number} names no picture.")
        if light["picture"] in (other["picture"] for other in lights[: number - 1]):
            raise BrdfkitError(f"{path}: {light['picture']} is named twice; each has one light.")
    return lights


def read_intensity(what: str, light: dict[str, Any]) -> FloatArray:
    """Return the intensity (3,) in the table of a light; `what` names the light in errors."""
    power = light.get("intensity", 1.0)
    power = power if isinstance(power, list) else [power] * 3
    return read_numbers(f"{what} intensity", power, (3,))


def read_number(what: str, value: object) -> float:
    """Return an entry of capture.toml as a number; `what` names the entry in errors."""
    return to_number(what, value, -LARGEST_NUMBER, LARGEST_NUMBER)


def read_length(what: str, value: object) -> float:
    """Return an entry of capture.toml as a number above 0; `what` names the entry in errors."""
    return to_number(what, value, None, LARGEST_NUMBER, above=0)


def read_numbers(what: str, value: object, shape: tuple[int, ...]) -> FloatArray:
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


def check_keys(path: Path, table: object, known: Iterable[str], where: str) -> None:
    """Raise `BrdfkitError` unless an entry of capture.toml is a table with `known` keys alone."""
    known = tuple(known)
    if not isinstance(table, dict):
        raise BrdfkitError(f"{path}: {where} should be a table, of {', '.join(known)}.")
    for name in table:
        if name not in known:
            raise BrdfkitError(
                f"{path}: {where} has {name!r}, which is not known; known are {', '.join(known)}."
            )
