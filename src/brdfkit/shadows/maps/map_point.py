"""A surface point on a shadow map, and the bias that keeps a surface from shadowing itself.

The light sees a surface at the centres of texels, the camera between them: without a bias half of a
slanted surface lies behind the surface that the light saw (acne). Too large a bias loses shadows
where they begin (peter-panning) [Ergun 2008, 3.1.2].
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitMask, JitVector
from brdfkit.shadows.maps.projection import AnyProjection


@dataclass(frozen=True)
class Bias:
    """Ways to move a receiver before it is compared with a map, which add up.

    constant : towards the light, over the reach of the light through the scene, in [0, 1].
    slope : towards the light, in steps of depth between neighbouring texels of the surface's plane.
    normal_offset : along the normal, in texels.
    plane : whether each texel is compared with the depth of the surface's plane at its centre; a
        flat surface then needs no other bias.
    """

    constant: float = 0.0
    slope: float = 0.0
    normal_offset: float = 0.0
    plane: bool = False


AUTOMATIC = Bias(constant=5e-4, plane=True)


@dataclass(frozen=True)
class MapPoint:
    """The place of a surface point on a map, and the slope of its surface's plane there.

    u, v : the place in texels; whole numbers are edges.
    depth : in the projection's cube, less the bias.
    slope_u, slope_v : change of depth in the plane of the surface, per texel; 0 where planes are
        not followed.
    active : whether the map shows the point at all.
    p : the point itself, moved along its normal if the bias does so.
    projection : the map's, opaque.
    half : half the number of texels along a side.
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

    def plane_depth(self, u: JitFloat, v: JitFloat) -> JitFloat:
        """Return the depth of the surface's plane at another place of the map."""
        return self.depth + self.slope_u * (u - self.u) + self.slope_v * (v - self.v)

    def move_to_depth(self, depth: JitFloat) -> JitVector:
        """Return the `mi.Point3f` on the same ray of light with this `depth` in the map's cube."""
        import mitsuba as mi

        x, y = self.u / self.half - 1, self.v / self.half - 1
        return mi.Point3f(*self.projection.from_map(x, y, depth))

    def cross_section_axes(self) -> list[tuple[JitFloat, JitFloat]]:
        """Return two unit vectors across the light, as vectors (u, v) on the map [texels]."""
        import mitsuba as mi

        ways = mi.coordinate_system(self.projection.to_light(self.p))
        steps = [self.projection.derivative_along(self.p, way) for way in ways]
        return [(u * self.half, v * self.half) for u, v, _ in steps]


def find_map_point(
    projection: AnyProjection,
    resolution: int,
    p: JitVector,
    n: JitVector,
    bias: Bias,
    reach: float,
    active: JitMask = True,
) -> MapPoint:
    """Return the place of points `p` with surface normals `n` on the map of an opaque projection.

    The plane of the surface is d(u, v) = depth + slope_u Δu + slope_v Δv, from the derivatives of
    the projection along two tangents [Isidoro 2006, receiver plane depth bias].

    reach : the longest way of light through the scene, the unit of the bias's constant.
    """
    import mitsuba as mi

    half = dr.opaque(mi.Float, resolution / 2)
    to_light = projection.to_light(p)
    n = dr.mulsign(n, dr.dot(n, to_light))
    slope_u, slope_v, texel = plane_slopes(projection, half, p, n)
    if bias.normal_offset:
        p = p + n * texel * dr.opaque(mi.Float, bias.normal_offset)
    x, y, depth = projection.to_map(*p)
    if bias.constant:
        step = dr.abs(projection.derivative_along(p, to_light)[2])
        depth = depth - step * dr.opaque(mi.Float, bias.constant * reach)
    if bias.slope:
        steepest = dr.maximum(dr.abs(slope_u), dr.abs(slope_v))
        depth = depth - dr.opaque(mi.Float, bias.slope) * steepest
    if not bias.plane:
        slope_u, slope_v = mi.Float(0), mi.Float(0)
    active = active & projection.is_before(*p)
    u, v = (x + 1) * half, (y + 1) * half
    return MapPoint(u, v, depth, slope_u, slope_v, active, p, projection, half)


def plane_slopes(
    projection: AnyProjection, half: JitFloat, p: JitVector, n: JitVector
) -> tuple[JitFloat, JitFloat, JitFloat]:
    """Return the slopes of the plane through `p` with normal `n`, and the length of a texel on it.

    The slopes are changes of depth per texel along u and v; the length is in units of the world.
    """
    import mitsuba as mi

    s, t = mi.coordinate_system(n)
    u_s, v_s, d_s = projection.derivative_along(p, s)
    u_t, v_t, d_t = projection.derivative_along(p, t)
    area = (u_s * v_t - u_t * v_s) * half
    inverse = dr.select(area != 0, dr.rcp(area), 0)  # a plane seen edge-on is a line on the map
    slope_u = (d_s * v_t - d_t * v_s) * inverse
    slope_v = (d_t * u_s - d_s * u_t) * inverse
    return slope_u, slope_v, dr.safe_sqrt(dr.abs(inverse) / half)
