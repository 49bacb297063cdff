"""The first pass: what the light sees, ray-traced through a projection, as a picture of depths."""

import drjit as dr
import numpy as np


def depth_pass(scene, projection, resolution):
    """The `mi.TensorXf` (resolution, resolution) of depths, row by row from y = -1 upwards.

    The depth is that of the first surface along each texel's ray of light, wherever it is: one
    before the cube has a depth below -1. Texels without a surface have infinity. Derivatives by
    the scene's geometry are kept.

    scene : a `mi.Scene`.
    projection : a `Projection`.
    """
    import mitsuba as mi

    opaque = projection.opaque()
    index = dr.arange(mi.UInt32, resolution**2)
    texel = dr.opaque(mi.Float, 2 / resolution)
    x = (mi.Float(index % resolution) + 0.5) * texel - 1
    y = (mi.Float(index // resolution) + 0.5) * texel - 1
    ray = ray_of_light(opaque, x, y, scene.bbox())
    si = scene.ray_intersect(ray)
    depth = opaque.to_map(*si.p)[2]
    # beyond the horizon of a warped map there are no rays
    seen = si.is_valid() & opaque.is_before(*si.p)
    return mi.TensorXf(dr.select(seen, depth, dr.inf), (resolution, resolution))


def ray_of_light(opaque, x, y, bounds):
    """The `mi.Ray3f` of light at the place (x, y) of a map, from outside `bounds`."""
    import mitsuba as mi

    origin, direction = (mi.Vector3f(*vector) for vector in opaque.ray(x, y))
    if opaque.light.is_directional:
        radius = np.linalg.norm(np.ravel(bounds.extents())) / 2
        away = dr.norm(origin - mi.Vector3f(bounds.center())) + dr.opaque(mi.Float, float(radius))
        origin -= away * direction
    return mi.Ray3f(mi.Point3f(origin), direction)
