"""Makes the small scenes with known radiance that check integrators."""

from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray


def make_film(size: int = 8) -> dict[str, Any]:
    """Return the dictionary of a small square film, in colour unless the variant has none."""
    import mitsuba as mi

    pixels = "luminance" if mi.is_monochromatic else "rgb"
    edges = {"width": size, "height": size, "rfilter": {"type": "box"}}
    return {"type": "hdrfilm", "pixel_format": pixels, **edges}


def make_cube_camera() -> dict[str, Any]:
    """Return the dictionary of a camera whose rays all go through the unit cube, along -z."""
    import mitsuba as mi

    to_world = mi.ScalarTransform4f().look_at([0.5, 0.5, 3], [0.5, 0.5, 0], [0, 1, 0]).scale(0.4)
    return {"type": "orthographic", "to_world": to_world, "film": make_film()}


def make_shadow_scene(integrator: dict[str, Any]) -> tuple[dict[str, Any], AnyArray]:
    """Return a scene with an integrator, and the radiance (3,) of its ground in the sun.

    The sun shines aslant on a wide matt ground; the radiance is albedo × irradiance × cosine / π.
    A ball outside the picture casts its shadow beside the picture, so that all pixels are equal.
    """
    import mitsuba as mi

    albedo, irradiance = 0.5, np.array([0.9, 0.6, 0.3])
    t = mi.ScalarTransform4f
    camera = t().look_at([0, 0, 4], [0, 0, 0], [0, 1, 0])
    film = make_film()
    scene = {
        "type": "scene",
        "integrator": integrator,
        "sensor": {"type": "perspective", "fov": 20, "to_world": camera, "film": film},
        "sun": {
            "type": "directional",
            "direction": [1, 0, -1],
            "irradiance": {"type": "rgb", "value": irradiance.tolist()},
        },
        "ground": {
            "type": "rectangle",
            "to_world": t().scale(5),
            "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": albedo}},
        },
        "ball": {"type": "sphere", "center": [-0.8, 0, 2], "radius": 0.3},
    }
    return scene, albedo / np.pi * irradiance * np.sqrt(0.5)
