"""The first pass of a shadow map: the light's view, ray-traced, as a picture of depths."""

import drjit as dr
import numpy as np

from brdfkit.core.array_types import JitFloat, JitVector, MitsubaObject
from brdfkit.shadows.maps.projection import AnyProjection


def render_depths(
    scene: MitsubaObject, projection: AnyProjection, resolution: int
) -> MitsubaObject:
    """Return the `mi.TensorXf` (resolution, resolution) of depths, rows from y = -1 upwards.

    A texel holds the depth of the first surface along its ray of light; a surface before the map's
    cube has a depth below -1. Texels without a surface hold infinity. Derivatives by the scene's
    geometry are kept.
    """
    opaque = projection.opaque()
    si = scene.ray_intersect(texel_rays(scene, opaque, resolution))
    return to_square(dr.select(si.is_valid(), depth_of(opaque, si.p), dr.inf), resolution)


def texel_rays(scene: MitsubaObject, opaque: AnyProjection, resolution: int) -> MitsubaObject:
    """Return the `mi.Ray3f` of light through the middle of each texel of an opaque projection.

    Rays of a directional light start outside of the scene.
    """
    import mitsuba as mi

    index = dr.arange(mi.UInt32, resolution**2)
    texel = dr.opaque(mi.Float, 2 / resolution)
    side = dr.opaque(mi.UInt32, resolution)
    x = (mi.Float(index % side) + 0.5) * texel - 1
    y = (mi.Float(index // side) + 0.5) * texel - 1
    origin, direction = (mi.Vector3f(*vector) for vector in opaque.ray(x, y))
    if opaque.light.is_directional:
        bounds = scene.bbox()
        radius = float(np.linalg.norm(np.ravel(bounds.extents()))) / 2
        away: JitFloat = dr.norm(origin - mi.Vector3f(bounds.center()))
        away = away + dr.opaque(mi.Float, radius)
        origin -= away * direction
    return mi.Ray3f(mi.Point3f(origin), direction)


def depth_of(opaque: AnyProjection, p: JitVector) -> JitFloat:
    """Return the depth of points; infinity beyond the horizon of a warped map."""
    return dr.select(opaque.is_before(*p), opaque.to_map(*p)[2], dr.inf)


def to_square(values: JitFloat, resolution: int) -> MitsubaObject:
    """Return the values of texels as a `mi.TensorXf` (resolution, resolution)."""
    import mitsuba as mi

    return mi.TensorXf(values, (resolution, resolution))
