"""Lights a scene with an environment map, in place of the scene's sky and softbox."""

from pathlib import Path
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray, MitsubaObject
from brdfkit.core.colours import luminance
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.geometry.latitude_rows import projected_solid_angles
from brdfkit.lighting.environments.map_files import load_radiance

ILLUMINANCE = 1.0  # illuminance of level ground by a map, the same as by a scene's sky and softbox


def describe_environment(environment: str | Path | AnyArray) -> dict[str, Any]:
    """Return the emitter dictionary of an environment map by latitude and longitude.

    `environment` is the name of a map, an HDR file, or an array (height, width, 3). The map is
    scaled to give the ground the same illuminance as the scenes' own lights, so pictures need no
    other exposure.

    Raises `BrdfkitError` for a file that is missing or that Mitsuba cannot read, for a map whose
    width is not twice its height, or whose upper half is black, and for radiance that is negative
    or not finite.
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
        "to_world": mi.ScalarTransform4f().rotate([1, 0, 0], 90),  # y points up in maps, here z
    }


def replace_lower_half(light: dict[str, Any], reflectance: float) -> dict[str, Any]:
    """Return an environment map whose lower half shows matte ground, lit by the upper half.

    `light` is the map's dictionary from `describe_environment`, and `reflectance` is the ground's.
    """
    import mitsuba as mi

    rgb = np.array(light["bitmap"])
    rgb[len(rgb) // 2 :] = reflectance / np.pi * _compute_ground_irradiance(rgb)
    return light | {"bitmap": mi.Bitmap(rgb)}


def _compute_ground_irradiance(rgb: FloatArray) -> FloatArray:
    """Return the irradiance (3,) of level ground, lit by a map (height, width, 3) of radiance."""
    return projected_solid_angles(*rgb.shape[:2]) @ rgb.astype(float).sum(axis=1)


def replace_light(light: dict[str, Any] | MitsubaObject, scene: dict[str, Any]) -> dict[str, Any]:
    """Return the dictionary of a `scene` with one `light` in place of its sky and softbox.

    Raises `BrdfkitError` for a scene without a sky, because it has lamps of its own.
    """
    if not isinstance(scene, dict) or "sky" not in scene:
        raise BrdfkitError("The scene has lamps of its own: leave envmap out, or choose another.")
    return {key: value for key, value in scene.items() if key != "softbox"} | {"sky": light}
