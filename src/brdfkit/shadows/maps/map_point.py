"""Receivers on a shadow map, with the bias that keeps a surface from shadowing itself.

The light sees a surface at the centres of texels, the camera between them: without a bias half of a
slanted surface lies behind the surface that the light saw (acne). Too large a bias detaches shadows
from the objects that cast them (peter-panning) [Ergun 2008, 3.1.2].
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitMask, JitVector
from brdfkit.shadows.maps.projection import AnyProjection


@dataclass(frozen=True)
class Bias:
    """Ways to move a receiver before its depth is compared with a shadow map; they add up.

    constant : distance towards the light, as a share of the longest light ray through the scene.
    slope : distance towards the light, in units of how much the depth of the receiver's plane
        changes from one texel to the next.
    normal_offset : distance along the surface normal, in texels.
    plane : whether each texel is compared with the depth of the receiver's plane at its centre; a
        flat surface then needs no other bias.
    """

    constant: float = 0.0
    slope: float = 0.0
    normal_offset: float = 0.0
    plane: bool = False


AUTOMATIC = Bias(constant=5e-4, plane=True)


@dataclass(frozen=True)
class MapPoint:
    """A receiver's place on a shadow map, and the slope of its surface there.

    u, v : place in texels; whole numbers are the edges of texels.
    depth : depth in the map, less the bias.
    slope_u, slope_v : change of depth per texel in the plane of the surface; 0 if `Bias.plane` is
        off.
    active : whether the projection maps the point at all.
    p : the point in the world, moved along its normal if the bias does so.
    projection : the map's projection, made opaque.
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
        """Return the depth of the receiver's plane at the place (u, v) of the map [texels]."""
        return self.depth + self.slope_u * (u - self.u) + self.slope_v * (v - self.v)

    def move_to_depth(self, depth: JitFloat) -> JitVector:
        """Return the `mi.Point3f` at a `depth` of the map on the light ray through the receiver."""
        import mitsuba as mi

        x, y = self.u / self.half - 1, self.v / self.half - 1
        return mi.Point3f(*self.projection.unproject(x, y, depth))

    def cross_section_axes(self) -> list[tuple[JitFloat, JitFloat]]:
        """Return the map's images (u, v) [texels] of two unit vectors at right angles to the light.

        They map a disk that faces the light at the receiver to an ellipse of texels.
        """
        import mitsuba as mi

        ways = mi.coordinate_system(self.projection.direction_to_light(self.p))
        steps = [self.projection.directional_derivative(self.p, way) for way in ways]
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
    """Return where receivers `p` with surface normals `n` lie on a shadow map, after the bias.

    Around it, their plane has the depth d(u, v) = depth + slope_u Δu + slope_v Δv, by the
    derivatives of the projection along two tangents [Isidoro 2006, receiver plane depth bias].

    projection : the map's projection, made opaque.
    reach : length of the longest light ray through the scene, of which `bias.constant` is a share.
    """
    import mitsuba as mi

    half = dr.opaque(mi.Float, resolution / 2)
    to_light = projection.direction_to_light(p)
    n = dr.mulsign(n, dr.dot(n, to_light))
    slope_u, slope_v, texel = plane_slopes(projection, half, p, n)
    if bias.normal_offset:
        p = p + n * texel * dr.opaque(mi.Float, bias.normal_offset)
    x, y, depth = projection.project(*p)
    if bias.constant:
        step = dr.abs(projection.directional_derivative(p, to_light)[2])
        depth = depth - step * dr.opaque(mi.Float, bias.constant * reach)
    if bias.slope:
        steepest = dr.maximum(dr.abs(slope_u), dr.abs(slope_v))
        depth = depth - dr.opaque(mi.Float, bias.slope) * steepest
    if not bias.plane:
        slope_u, slope_v = mi.Float(0), mi.Float(0)
    active = active & projection.is_projectable(*p)
    u, v = (x + 1) * half, (y + 1) * half
    return MapPoint(u, v, depth, slope_u, slope_v, active, p, projection, half)


def plane_slopes(
    projection: AnyProjection, half: JitFloat, p: JitVector, n: JitVector
) -> tuple[JitFloat, JitFloat, JitFloat]:
    """Return the depth slopes of the plane through `p` with normal `n`, and a texel's length on it.

    The slopes are changes of depth per texel along u and v; the length is in units of the world.

    projection : the map's projection, made opaque.
    half : half the number of texels along a side of the map.
    """
    import mitsuba as mi

    s, t = mi.coordinate_system(n)
    u_s, v_s, d_s = projection.directional_derivative(p, s)
    u_t, v_t, d_t = projection.directional_derivative(p, t)
    area = (u_s * v_t - u_t * v_s) * half
    inverse = dr.select(area != 0, dr.rcp(area), 0)  # a plane seen edge-on is a line on the map
    slope_u = (d_s * v_t - d_t * v_s) * inverse
    slope_v = (d_t * u_s - d_s * u_t) * inverse
    return slope_u, slope_v, dr.safe_sqrt(dr.abs(inverse) / half)
