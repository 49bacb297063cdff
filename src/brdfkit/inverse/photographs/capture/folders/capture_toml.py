"""Folders with the file capture.toml whose table `[object]` stands in the place of `[sample]`.

Each table `[[light]]` has a `direction` to a distant light, or the `position` of a lamp [m], which
may have an `axis` along which it shines and the `exponent` µ of its radiant intensity I cos^µ.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from brdfkit.core.arguments import to_number
from brdfkit.core.array_types import FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import require_file
from brdfkit.inverse.photographs.capture import toml_entries as toml
from brdfkit.inverse.photographs.capture.lights import Lights
from brdfkit.inverse.photographs.capture.listing import Listing
from brdfkit.inverse.photographs.capture.making_lights import make_distant_lights
from brdfkit.inverse.photographs.capture.pictures.masks import find_mask_file

NAME = "capture.toml with [object]"
LARGEST_EXPONENT = 1000.0
OBJECT_KEYS = "name", "mask", "pixel_size", "width"
CAMERA_KEYS = "distance", "fov"
LIGHT_KEYS = "picture", "direction", "position", "axis", "exponent", "intensity"


def find_listing(folder: Path) -> Listing | None:
    """Return the `Listing` of a folder whose capture.toml describes an object, or None."""
    if not (folder / toml.NAME).is_file():
        return None
    tables = toml.read_tables(folder)
    if "object" not in tables:
        return None
    path = folder / toml.NAME
    if "sample" in tables:
        raise BrdfkitError(f"{path}: it has [sample] and [object]; leave the one that it shows.")
    shown, camera = tables["object"], tables.get("camera", {})
    toml.check_keys(path, shown, OBJECT_KEYS, "[object]")
    toml.check_keys(path, camera, CAMERA_KEYS, "[camera]")
    if "pixel_size" in shown and "width" in shown:
        raise BrdfkitError(f"{path}: [object] has pixel_size and width; one of them is enough.")

    def read_length(table: str, key: str) -> float | None:
        """Return an entry of a table as a number above 0, None without such an entry."""
        value = tables.get(table, {}).get(key)
        return None if value is None else toml.read_length(f"{path}: [{table}] {key}", value)

    distance = read_length("camera", "distance")
    tables_of_lights = toml.read_lights(path, tables, LIGHT_KEYS)
    mask = folder / str(shown["mask"]) if "mask" in shown else find_mask_file(folder)
    return Listing(
        name=str(shown.get("name", folder.resolve().name)),
        photographs=tuple(require_file(folder / light["picture"]) for light in tables_of_lights),
        lights=_read_lights(path, tables_of_lights, distance),
        lights_file=path,
        has_intensities=any("intensity" in light for light in tables_of_lights),
        mask=None if mask is None else require_file(mask),
        pixel_size=read_length("object", "pixel_size"),
        width=read_length("object", "width"),
        distance=distance,
        fov=read_length("camera", "fov"),
    )


def _read_lights(path: Path, tables: list[dict[str, Any]], distance: float | None) -> Lights:
    """Return the lights in the tables `[[light]]`, all distant, or all lamps.

    `distance` is that of the camera [m], which a ring flash shares.
    """
    intensities = np.array([toml.read_intensity(_name(path, table), table) for table in tables])
    if (intensities < 0).any() or not (intensities > 0).any(axis=1).all():
        raise BrdfkitError(f"{path}: each light needs an intensity above 0, and none below.")
    for table in tables:
        if ("direction" in table) == ("position" in table):
            raise BrdfkitError(
                f"{_name(path, table)} its light should have either a direction, if it is far "
                "away, or a position."
            )
        if "direction" in table and ("axis" in table or "exponent" in table):
            raise BrdfkitError(
                f"{_name(path, table)} only a light with a position has an axis and an exponent."
            )
    distant = ["direction" in table for table in tables]
    if all(distant):
        vectors = [_read_vector(path, table, "direction") for table in tables]
        return make_distant_lights(path, np.array(vectors), intensities)
    if any(distant):
        raise BrdfkitError(
            f"{path}: some lights have directions and others positions; give one kind for all."
        )
    positions = np.array([_read_position(path, table, distance) for table in tables])
    directions = make_distant_lights(path, positions).directions
    if not any("axis" in table or "exponent" in table for table in tables):
        return Lights(directions, intensities, positions)
    axes = np.array(
        [
            _read_vector(path, table, "axis") if "axis" in table else -direction
            for table, direction in zip(tables, directions, strict=True)
        ]
    )
    exponents = [
        to_number(f"{_name(path, table)} exponent", table.get("exponent", 0.0), 0, LARGEST_EXPONENT)
        for table in tables
    ]
    return Lights(directions, intensities, positions, axes, np.array(exponents))


def _read_vector(path: Path, table: dict[str, Any], key: str) -> FloatArray:
    """Return a vector in the table of a light as a unit vector (3,)."""
    what = f"{_name(path, table)} {key}"
    vector = toml.read_numbers(what, table[key], (3,))
    length = np.linalg.norm(vector)
    if not length > 0:
        raise BrdfkitError(f"{what}: the vector is zero; give one from the object to the light.")
    unit: FloatArray = vector / length
    return unit


def _read_position(path: Path, table: dict[str, Any], distance: float | None) -> FloatArray:
    """Return the position (3,) [m] of a lamp; that of a ring flash is at the camera."""
    if table["position"] != toml.AT_CAMERA:
        return toml.read_numbers(f"{_name(path, table)} position", table["position"], (3,))
    if distance is None:
        raise BrdfkitError(
            f"{_name(path, table)} its flash is at the camera; give [camera] distance, in metres."
        )
    return np.array([0.0, 0.0, distance])


def _name(path: Path, table: dict[str, Any]) -> str:
    """Return the words that name the table of a light in errors."""
    return f"{path}: {table['picture']}:"
