"""Loads the material of a scene, and finds the pixels of a picture that show it."""

from typing import Any

import numpy as np

from brdfkit.core.array_types import BoolArray, MitsubaObject
from brdfkit.core.jit.padding import pad
from brdfkit.mitsuba_bridge.properties.picture_file import load_by_mitsuba


def load_material(bsdf: dict[str, Any], name: str, both_sides: bool = False) -> MitsubaObject:
    """Load the BSDF that a dictionary describes; error messages call it `name`.

    With `both_sides` the material also reflects at the back of a surface, which meshes may show. A
    material that transmits light does so anyway.
    """
    import mitsuba as mi

    material = load_by_mitsuba(mi.load_dict, bsdf, name)
    if not both_sides or mi.has_flag(material.flags(), mi.BSDFFlags.Transmission):
        return material
    return mi.load_dict({"type": "twosided", "bsdf": material}, parallel=False)


def find_material_mask(scene: MitsubaObject, material: MitsubaObject) -> BoolArray:
    """Return the mask (height, width) of the pixels whose central ray hits the material.

    `scene` is a `mitsuba.Scene`, and `material` the BSDF object in it.
    """
    import mitsuba as mi

    sensor = scene.sensors()[0]
    width, height = map(int, sensor.film().crop_size())
    x, y = np.meshgrid((np.arange(width) + 0.5) / width, (np.arange(height) + 0.5) / height)

    def find_shape(place: Any) -> MitsubaObject:
        ray, _ = sensor.sample_ray(0.0, 0.5, place, mi.Point2f(0.5))
        return scene.ray_intersect_preliminary(ray).shape

    if str(mi.variant()).startswith("scalar"):  # scalar variants can only trace rays one by one
        shapes = (find_shape(mi.Point2f(*p)) for p in zip(x.flat, y.flat, strict=True))
        mask = np.array([s is not None and s.bsdf() is material for s in shapes])
    else:
        shape = find_shape(mi.Point2f(*(pad(a.ravel().astype(np.float32)) for a in (x, y))))
        mask = np.array(shape.bsdf() == mi.BSDFPtr(material))
    return mask.reshape(height, width)
