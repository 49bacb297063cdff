"""A point of a surface as a shadow map sees it."""

from dataclasses import dataclass
from typing import Any

import drjit as dr


@dataclass(frozen=True)
class MapPoint:
    """Where a point falls on a map, and how its surface's plane leans there.

    u, v : the place in texels; whole numbers are edges.
    depth : in the projection's cube, less the bias.
    slope_u, slope_v : change of depth in the plane of the surface, per texel; 0 where planes are
        not followed.
    active : whether the map shows the point at all.
    p : the point itself, as far as it was moved along its normal.
    projection : the map's, opaque.
    half : texels along half a side.
    """

    u: Any
    v: Any
    depth: Any
    slope_u: Any
    slope_v: Any
    active: Any
    p: Any
    projection: Any
    half: Any

    def depth_at(self, u, v):
        """The depth of the surface's plane at another place of the map."""
        return self.depth + self.slope_u * (u - self.u) + self.slope_v * (v - self.v)

    def before(self, depth):
        """The `mi.Point3f` on the same ray of light that has a `depth` of the projection's cube."""
        import mitsuba as mi

        x, y = self.u / self.half - 1, self.v / self.half - 1
        return mi.Point3f(*self.projection.from_map(x, y, depth))

    def across(self):
        """The ways on the map (u, v), in texels, of the point's two ways of length 1 across the
        light."""
        import mitsuba as mi

        ways = mi.coordinate_system(self.projection.to_light(self.p))
        steps = [self.projection.along(self.p, way) for way in ways]
        return [(u * self.half, v * self.half) for u, v, _ in steps]


def map_point(projection, resolution, p, n, bias, reach, active=True):
    """The `MapPoint` of a point `p` with the normal `n` under an opaque `Projection`.

    The plane of the surface is d(u, v) = depth + slope_u Δu + slope_v Δv, from the derivatives of
    the projection along two tangents [Isidoro 2006, receiver plane depth bias].

    bias : a `Bias`.
    reach : of the light through the scene, the unit of the bias's constant.
    """
    import mitsuba as mi

    half = dr.opaque(mi.Float, resolution / 2)
    to_light = projection.to_light(p)
    n = dr.mulsign(n, dr.dot(n, to_light))
    slope_u, slope_v, texel = plane_on_map(projection, half, p, n)
    if bias.normal_offset:
        p = p + n * texel * dr.opaque(mi.Float, bias.normal_offset)
    x, y, depth = projection.to_map(*p)
    if bias.constant:
        step = dr.abs(projection.along(p, to_light)[2])
        depth = depth - step * dr.opaque(mi.Float, bias.constant * reach)
    if bias.slope:
        steepest = dr.maximum(dr.abs(slope_u), dr.abs(slope_v))
        depth = depth - dr.opaque(mi.Float, bias.slope) * steepest
    if not bias.plane:
        slope_u, slope_v = mi.Float(0), mi.Float(0)
    active = active & projection.is_before(*p)
    u, v = (x + 1) * half, (y + 1) * half
    return MapPoint(u, v, depth, slope_u, slope_v, active, p, projection, half)


def plane_on_map(projection, half, p, n):
    """Of the plane through `p` with the normal `n`: the change of depth per texel along u and v,
    and the length of a texel on it [unit of length]."""
    import mitsuba as mi

    s, t = mi.coordinate_system(n)
    u_s, v_s, d_s = projection.along(p, s)
    u_t, v_t, d_t = projection.along(p, t)
    area = (u_s * v_t - u_t * v_s) * half
    inverse = dr.select(area != 0, dr.rcp(area), 0)  # a plane seen edge on has no depth elsewhere
    slope_u = (d_s * v_t - d_t * v_s) * inverse
    slope_v = (d_t * u_s - d_s * u_t) * inverse
    return slope_u, slope_v, dr.safe_sqrt(dr.abs(inverse) / half)
