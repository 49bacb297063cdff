"""Describes the light on a volume and the background behind it, as emitters for Mitsuba."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from brdfkit.core.array_types import FloatArray
from brdfkit.lighting.environments.light_distribution import pixel_directions
from brdfkit.rendering.scene_input.environment import describe_environment
from brdfkit.rendering.volumes.camera import FOV

EDGE = 2.0  # margin of the background around the picture [degrees], because maps are interpolated


def make_background_light(background: ArrayLike) -> dict[str, Any]:
    """Return an emitter with the same radiance, a number or R, G, B, in all directions."""
    rgb = np.broadcast_to(background, 3).tolist()
    return {"type": "constant", "radiance": {"type": "rgb", "value": rgb}}


def make_environment_light(
    environment: str | Path,
    illuminance: float,
    background: ArrayLike | None,
    towards: FloatArray,
    aspect: float,
) -> dict[str, Any]:
    """Return the emitter of an environment map with a uniform `background` behind the volume.

    The camera sees this background, and the light from all other directions is that of the map. If
    it is None, the camera sees the map itself. The whole map gives level ground this `illuminance`.
    `towards` is the unit vector to the camera, and `aspect` the picture's width divided by its
    height.
    """
    import mitsuba as mi

    light = describe_environment(environment)
    light["scale"] *= illuminance
    if background is None:
        return light
    half = np.tan(np.radians(FOV / 2))
    corner = np.degrees(np.arctan(half * np.hypot(max(aspect, 1), max(1 / aspect, 1))))
    rgb = np.array(light["bitmap"])
    x, y, z = -towards
    cosine = pixel_directions(*rgb.shape[:2]) @ [x, z, -y]  # in the map's axes y points up
    behind = cosine > np.cos(np.radians(corner + EDGE))
    rgb[behind] = np.broadcast_to(background, 3) / light["scale"]
    return light | {"bitmap": mi.Bitmap(rgb)}
