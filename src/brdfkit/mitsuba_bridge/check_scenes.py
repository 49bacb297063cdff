"""The small scene with known radiance by which integrators with shadows are checked."""

import numpy as np

from brdfkit.mitsuba_bridge.reference_camera import reference_film


def beside_a_shadow(integrator):
    """A scene with the dictionary of an `integrator`, and the radiance (3,) of each of its pixels:
    ρ E cosθ / π.

    The sun shines aslant on a wide ground; a ball shadows another part of it.
    """
    import mitsuba as mi

    albedo, irradiance = 0.5, np.array([0.9, 0.6, 0.3])
    t = mi.ScalarTransform4f
    camera = t().look_at([0, 0, 4], [0, 0, 0], [0, 1, 0])
    film = reference_film()
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
        "ball": {"type": "sphere", "center": [-1, 0, 2], "radius": 0.3},
    }
    return scene, albedo / np.pi * irradiance * np.sqrt(0.5)
