"""Projective shadow texture: casters in one flat colour, thrown onto what is behind them.

The light draws the silhouettes of casters, and receivers look up whether one covers their texel.
An object is a caster or a receiver of one shadow, never both, so that none shadows itself. Here,
that is as a map of depths midway between each caster's last surface and the first of another shape
behind it; one look-up of that tells which of the two a point belongs to. There is no acne and no
bias; shapes that were merged into one do not shadow each other.

[Ergun 2008, 2.2.1.1], [Woo 1992]
"""

import drjit as dr

from brdfkit.mitsuba_bridge.surface_points import clearance
from brdfkit.shadows.maps.depth_pass import depth_of, rays_of_light, square
from brdfkit.shadows.maps.texels import Texels

DEEPEST = 64  # surfaces of one caster that a ray goes through


class Lookup:
    """A map of where shadows begin, texel by texel."""

    def __init__(self, depths):
        self.texels = Texels(depths)

    def lit(self, point):
        """The share of the light that arrives at a `MapPoint`: 0 or 1."""
        return self.texels.lit(point, point.u, point.v)


def see(scene, projection, resolution):
    """The `mi.TensorXf` (resolution, resolution) of the depths between casters and receivers."""
    import mitsuba as mi

    opaque = projection.opaque()
    ray = rays_of_light(scene, opaque, resolution)
    first = scene.ray_intersect_preliminary(ray)
    caster = dr.reinterpret_array(mi.UInt32, first.shape)

    def goes_on(i, last, t, shape):
        return first.is_valid() & (shape == caster) & (i < DEEPEST)

    def step(i, last, t, shape):
        place = ray(t)
        begin = t + clearance(place, t)
        hit = scene.ray_intersect_preliminary(mi.Ray3f(ray(begin), ray.d))
        return i + 1, t, begin + hit.t, dr.reinterpret_array(mi.UInt32, hit.shape)

    start = mi.UInt32(0), mi.Float(first.t), mi.Float(first.t), mi.UInt32(caster)
    _, last, t, _ = dr.while_loop(start, goes_on, step)
    depth = (depth_of(opaque, ray(last)) + depth_of(opaque, ray(t))) / 2
    return square(dr.select(first.is_valid() & dr.isfinite(t), depth, dr.inf), resolution)
