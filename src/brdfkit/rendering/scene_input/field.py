"""A look at a distance field: from the front, the right and above, by two round lamps.

It fills the picture whatever its size: all lengths are in radii of a sphere about it, in which what
is endless, as a plane, does not count. Parts whose names (`made_of`) are those of materials are of
these materials, all others are grey.
"""

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.distance_fields.materials import material_names
from brdfkit.distance_fields.shadows.field import bounding_sphere
from brdfkit.materials.resolve import to_material
from brdfkit.mitsuba_bridge.properties.picture_file import load_by_mitsuba

SIZE = 400, 300  # pixels
SPP = 4  # there is no noise: they smooth edges
OPENING = 30.0  # the angle of view [degrees]
CAMERA = (0.35, -0.85, 0.45)  # in which direction it is
LAMPS = {  # centre, radius and radiance
    "key": ((-3.0, -2.5, 4.5), 0.7, 70.0),
    "fill": ((7.0, -5.0, 5.0), 3.0, 2.5),
}


def field_scene(field, size):
    """The `mitsuba.Scene` of a field, in a picture of this `size`."""
    import mitsuba as mi

    middle, radius = bounding_sphere(field)
    away = np.array(CAMERA) / np.linalg.norm(CAMERA) / np.sin(np.radians(OPENING / 2))
    look_at = mi.ScalarTransform4f().look_at
    scene = {
        "type": "scene",
        "integrator": {
            "type": "distance_field",
            "field": field.to_json(),
            **{name: bsdf(name) for name in material_names(field)},
        },
        "sensor": {
            "type": "perspective",
            "fov": OPENING,
            "fov_axis": "smaller",
            "near_clip": 1e-2 * radius,
            "far_clip": 1e3 * radius,
            "to_world": look_at((middle + radius * away).tolist(), middle.tolist(), [0, 0, 1]),
            "film": {"type": "hdrfilm", "width": size[0], "height": size[1]},
        },
    }
    for name, (centre, wide, radiance) in LAMPS.items():
        scene[name] = {
            "type": "sphere",
            "center": (middle + radius * np.array(centre)).tolist(),
            "radius": radius * wide,
            "emitter": {"type": "area", "radiance": radiance},
        }
    return load_by_mitsuba(mi.load_dict, scene, "field")


def bsdf(name):
    """The dictionary of the material called so, or of a grey one."""
    try:
        return to_material(name).scene_dict()
    except BrdfkitError:
        return {"type": "diffuse", "reflectance": 0.6}
