"""Loads the material of a scene, and finds the pixels of a picture that show it."""

from collections.abc import Callable
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray, BoolArray, FloatArray, MitsubaObject
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

    def shows_material(ray: MitsubaObject) -> Any:
        shape = scene.ray_intersect_preliminary(ray).shape
        if str(mi.variant()).startswith("scalar"):
            return shape is not None and shape.bsdf() is material
        return shape.bsdf() == mi.BSDFPtr(material)

    return map_central_rays(scene, shows_material)


def find_view_cosines(scene: MitsubaObject) -> FloatArray:
    """Return the cosines (height, width) of the angles between normals and the view, at least 0.

    They are those of the surface that the central ray of each pixel hits.
    """
    return np.abs(map_central_rays(scene, lambda ray: scene.ray_intersect(ray).wi.z))


def map_central_rays(scene: MitsubaObject, function: Callable[[MitsubaObject], Any]) -> AnyArray:
    """Return the values (height, width) of a function of each pixel's central ray.

    In scalar variants of Mitsuba, which trace rays one by one, the function takes one ray;
    otherwise it takes all of them.
    """
    import mitsuba as mi

    sensor = scene.sensors()[0]
    width, height = map(int, sensor.film().crop_size())
    x, y = np.meshgrid((np.arange(width) + 0.5) / width, (np.arange(height) + 0.5) / height)

    def evaluate(place: MitsubaObject) -> Any:
        ray, _ = sensor.sample_ray(0.0, 0.5, place, mi.Point2f(0.5))
        return function(ray)

    if str(mi.variant()).startswith("scalar"):
        values = [evaluate(mi.Point2f(*place)) for place in zip(x.flat, y.flat, strict=True)]
    else:
        values = evaluate(mi.Point2f(*(pad(a.ravel().astype(np.float32)) for a in (x, y))))
    return np.array(values).reshape(height, width)
