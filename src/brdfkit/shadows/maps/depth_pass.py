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
    opaque = projection.opaque()
    si = scene.ray_intersect(rays_of_light(scene, opaque, resolution))
    return square(dr.select(si.is_valid(), depth_of(opaque, si.p), dr.inf), resolution)


def rays_of_light(scene, opaque, resolution):
    """The `mi.Ray3f` of light through the middle of each texel of an opaque `Projection`."""
    import mitsuba as mi

    index = dr.arange(mi.UInt32, resolution**2)
    texel = dr.opaque(mi.Float, 2 / resolution)
    side = dr.opaque(mi.UInt32, resolution)
    x = (mi.Float(index % side) + 0.5) * texel - 1
    y = (mi.Float(index // side) + 0.5) * texel - 1
    return ray_of_light(opaque, x, y, scene.bbox())


def depth_of(opaque, p):
    """The depth of points; infinity beyond the horizon of a warped map, where no rays are."""
    return dr.select(opaque.is_before(*p), opaque.to_map(*p)[2], dr.inf)


def square(values, resolution):
    """The values of texels as a `mi.TensorXf` (resolution, resolution)."""
    import mitsuba as mi

    return mi.TensorXf(values, (resolution, resolution))


def ray_of_light(opaque, x, y, bounds):
    """The `mi.Ray3f` of light at the place (x, y) of a map, from outside `bounds`."""
    import mitsuba as mi

    origin, direction = (mi.Vector3f(*vector) for vector in opaque.ray(x, y))
    if opaque.light.is_directional:
        radius = np.linalg.norm(np.ravel(bounds.extents())) / 2
        away = dr.norm(origin - mi.Vector3f(bounds.center())) + dr.opaque(mi.Float, float(radius))
        origin -= away * direction
    return mi.Ray3f(mi.Point3f(origin), direction)
