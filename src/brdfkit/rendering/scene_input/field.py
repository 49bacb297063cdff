"""Makes the scene that shows a distance field: a camera and two spherical lamps around it.

The camera is in front of the field, to the right and above. All lengths are multiples of the radius
of the field's bounding sphere, so the field fills the picture whatever its size; the sphere does
not enclose infinite parts, such as planes. A part that is named after a material (`made_of`)
consists of that material; all other parts are grey.
"""

from typing import Any

import numpy as np

from brdfkit.core.array_types import MitsubaObject
from brdfkit.core.errors import BrdfkitError
from brdfkit.distance_fields import Node
from brdfkit.distance_fields.materials import list_material_names
from brdfkit.distance_fields.shadows.field import bounding_sphere
from brdfkit.materials.resolve import to_material
from brdfkit.mitsuba_bridge.properties.picture_file import load_by_mitsuba

SIZE = 400, 300  # default width and height of a picture [pixels]
SPP = 4  # default samples per pixel; they only smooth edges, as the shading has no noise
FIELD_OF_VIEW = 30.0  # angle of view along the picture's shorter side [degrees]
CAMERA = (0.35, -0.85, 0.45)  # direction from the field to the camera
# For each spherical lamp: centre, radius, and radiance; lengths are in radii of the bounding sphere
LAMPS = {
    "key": ((-3.0, -2.5, 4.5), 0.7, 70.0),
    "fill": ((7.0, -5.0, 5.0), 3.0, 2.5),
}


def load_field_scene(field: Node, size: tuple[int, int]) -> MitsubaObject:
    """Load the `mitsuba.Scene` that shows a distance field; `size` is (width, height) [pixels]."""
    import mitsuba as mi

    middle, radius = bounding_sphere(field)
    to_camera = np.array(CAMERA) / np.linalg.norm(CAMERA) / np.sin(np.radians(FIELD_OF_VIEW / 2))
    look_at = mi.ScalarTransform4f().look_at
    scene = {
        "type": "scene",
        "integrator": {
            "type": "distance_field",
            "field": field.to_json(),
            **{name: _describe_material(name) for name in list_material_names(field)},
        },
        "sensor": {
            "type": "perspective",
            "fov": FIELD_OF_VIEW,
            "fov_axis": "smaller",
            "near_clip": 1e-2 * radius,
            "far_clip": 1e3 * radius,
            "to_world": look_at((middle + radius * to_camera).tolist(), middle.tolist(), [0, 0, 1]),
            "film": {"type": "hdrfilm", "width": size[0], "height": size[1]},
        },
    }
    for name, (centre, lamp_radius, radiance) in LAMPS.items():
        scene[name] = {
            "type": "sphere",
            "center": (middle + radius * np.array(centre)).tolist(),
            "radius": radius * lamp_radius,
            "emitter": {"type": "area", "radiance": radiance},
        }
    return load_by_mitsuba(mi.load_dict, scene, "field")


def _describe_material(name: str) -> dict[str, Any]:
    """Return the BSDF dictionary of a material, or of a grey one if the name is unknown."""
    try:
        return to_material(name).scene_dict()
    except BrdfkitError:
        return {"type": "diffuse", "reflectance": 0.6}
