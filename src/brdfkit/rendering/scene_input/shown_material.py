"""The material that a scene shows: a BSDF of Mitsuba's, and the pixels where it is seen."""

import numpy as np

from brdfkit.core.jit.padding import pad
from brdfkit.mitsuba_bridge.properties.picture_file import load_by_mitsuba


def load_material(bsdf, name, both_sides=False):
    """The BSDF of a dictionary, as an object; `name`: for an error.

    `both_sides`: for surfaces that may show their backs; light that passes a material sees to it.
    """
    import mitsuba as mi

    material = load_by_mitsuba(mi.load_dict, bsdf, name)
    if not both_sides or mi.has_flag(material.flags(), mi.BSDFFlags.Transmission):
        return material
    return mi.load_dict({"type": "twosided", "bsdf": material}, parallel=False)


def mask(scene, material):
    """True (height, width) where the centre of a pixel sees the material, an object.

    `scene`: a `mitsuba.Scene` with it.
    """
    import mitsuba as mi

    sensor = scene.sensors()[0]
    width, height = map(int, sensor.film().crop_size())
    x, y = np.meshgrid((np.arange(width) + 0.5) / width, (np.arange(height) + 0.5) / height)

    def first_hit(place):
        ray, _ = sensor.sample_ray(0.0, 0.5, place, mi.Point2f(0.5))
        return scene.ray_intersect_preliminary(ray).shape

    if mi.variant().startswith("scalar"):  # one ray at a time
        shapes = (first_hit(mi.Point2f(*p)) for p in zip(x.flat, y.flat, strict=True))
        seen = np.array([s is not None and s.bsdf() is material for s in shapes])
    else:
        shape = first_hit(mi.Point2f(*(pad(a.ravel().astype(np.float32)) for a in (x, y))))
        seen = np.array(shape.bsdf() == mi.BSDFPtr(material))
    return seen.reshape(height, width)
