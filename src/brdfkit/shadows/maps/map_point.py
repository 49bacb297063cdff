"""Finds points to shade, receivers, on a shadow map, with a bias against self-shadowing.

The map stores the depth of a surface at the centres of texels, but the camera also sees the surface
between them. On a slanted surface half of these points are farther from the light than the stored
depth, and would be dark (acne). A bias moves points towards the light before the comparison; if it
is too large, shadows detach from the objects that cast them (peter-panning) [Ergun 2008, 3.1.2].
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitMask, JitVector
from brdfkit.shadows.maps.projection import AnyProjection


@dataclass(frozen=True)
class Bias:
    """How a receiver is moved before its depth is compared with a shadow map; all moves add up.

    constant : move towards the light, as a share of the longest light ray through the scene.
    slope : move towards the light, as a multiple of the change of the surface's depth from one
        texel to the next.
    normal_offset : move along the surface normal [widths of a texel].
    plane : whether a texel is compared with the depth of the receiver's tangent plane at the
        texel's centre, in place of the receiver's own depth; flat surfaces then need no other bias.
    """

    constant: float = 0.0
    slope: float = 0.0
    normal_offset: float = 0.0
    plane: bool = False


AUTOMATIC = Bias(constant=5e-4, plane=True)


@dataclass(frozen=True)
class MapPoint:
    """A receiver's place on a shadow map, and the slope of its surface there.

    u, v : the place [texels]; whole numbers are the edges of texels.
    depth : the receiver's depth on the map, less the bias.
    slope_u, slope_v : change of depth per texel along u and v in the receiver's tangent plane; 0 if
        `Bias.plane` is off.
    active : whether the projection can map the receiver at all.
    p : the receiver in the world, moved along its normal if the bias does so.
    projection : the map's projection, in opaque Dr.Jit numbers (`make_opaque`).
    half : half the number of texels along a side of the map.
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
        """Return the depth of the receiver's tangent plane at the place (u, v) [texels]."""
        return self.depth + self.slope_u * (u - self.u) + self.slope_v * (v - self.v)

    def move_to_depth(self, depth: JitFloat) -> JitVector:
        """Return the point on the light ray through the receiver that has a `depth` on the map."""
        import mitsuba as mi

        x, y = self.u / self.half - 1, self.v / self.half - 1
        return mi.Point3f(*self.projection.unproject(x, y, depth))

    def cross_section_axes(self) -> list[tuple[JitFloat, JitFloat]]:
        """Return the vectors (u, v) on the map [texels] of two unit vectors across the light's ray.

        With them, a disk at the receiver that faces the light becomes an ellipse of texels.
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

    The result also has the slope of the receiver's tangent plane on the map [Isidoro 2006, receiver
    plane depth bias].

    projection : the map's projection, in opaque Dr.Jit numbers (`make_opaque`).
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
    """Return the slopes on a map of the plane through `p` with normal `n`, and a texel's width.

    The slopes are the changes of depth per texel along u and v; the width is the mean width that a
    texel has on the plane [unit of length].

    projection : the map's projection, in opaque Dr.Jit numbers (`make_opaque`).
    half : half the number of texels along a side of the map.
    """
    import mitsuba as mi

    s, t = mi.coordinate_system(n)
    u_s, v_s, d_s = projection.directional_derivative(p, s)
    u_t, v_t, d_t = projection.directional_derivative(p, t)
    area = (u_s * v_t - u_t * v_s) * half
    inverse = dr.select(area != 0, dr.rcp(area), 0)  # 0 if the light sees the plane edge-on
    slope_u = (d_s * v_t - d_t * v_s) * inverse
    slope_v = (d_t * u_s - d_s * u_t) * inverse
    return slope_u, slope_v, dr.safe_sqrt(dr.abs(inverse) / half)
