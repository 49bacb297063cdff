"""Lights a scene with an environment map, in place of the scene's sky and softbox."""

from pathlib import Path
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray, MitsubaObject
from brdfkit.core.colours import luminance
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.geometry.latitude_rows import projected_solid_angles
from brdfkit.lighting.environments.map_files import load_radiance

ILLUMINANCE = 1.0  # illuminance of level ground, equal to that from a scene's sky and softbox


def describe_environment(environment: str | Path) -> dict[str, Any]:
    """Return the emitter dictionary of an environment map by latitude and longitude.

    `environment` is the name of a map or an HDR file. The map is scaled so that the ground receives
    the same illuminance as in the scenes, so pictures need no other exposure. Raises `BrdfkitError`
    for a file that is missing, that Mitsuba cannot read, or whose width is not twice its height,
    for radiance that is negative or not finite, and for a map whose upper half is black.
    """
    import mitsuba as mi

    name, rgb = load_radiance(environment)
    illuminance = luminance(_compute_ground_irradiance(rgb))
    if not illuminance > 0:
        raise BrdfkitError(f"{name}: the map gives no light from above; choose another.")
    return {
        "type": "envmap",
        "bitmap": mi.Bitmap(rgb),
        "scale": ILLUMINANCE / illuminance,
        "to_world": mi.ScalarTransform4f().rotate([1, 0, 0], 90),  # from y up in maps to z up
    }


def replace_lower_half(light: dict[str, Any], reflectance: float) -> dict[str, Any]:
    """Return an emitter whose lower half shows matte ground, lit by the map's upper half.

    `light` is a dictionary from `describe_environment`, and `reflectance` that of the ground.
    """
    import mitsuba as mi

    rgb = np.array(light["bitmap"])
    rgb[len(rgb) // 2 :] = reflectance / np.pi * _compute_ground_irradiance(rgb)
    return light | {"bitmap": mi.Bitmap(rgb)}


def _compute_ground_irradiance(rgb: FloatArray) -> FloatArray:
    """Return the irradiance (3,) of level ground under a map (height, width, 3) of radiance."""
    return projected_solid_angles(*rgb.shape[:2]) @ rgb.astype(float).sum(axis=1)


def replace_light(light: dict[str, Any] | MitsubaObject, scene: dict[str, Any]) -> dict[str, Any]:
    """Return the dictionary of a `scene` with one `light` in place of its sky and softbox.

    Raises `BrdfkitError` for a scene without a sky, because it has lamps of its own.
    """
    if not isinstance(scene, dict) or "sky" not in scene:
        raise BrdfkitError("The scene has lamps of its own: leave envmap out, or choose another.")
    return {key: value for key, value in scene.items() if key != "softbox"} | {"sky": light}
