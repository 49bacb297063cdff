"""`split`: a shadow by several narrow cones, each with its own march and its own straight edge.

One straight edge is wrong for small and pointed occluders, and for several of them. So the disc is
cut into a centre and rings of 6, 12 ... cells of equal area, and a cone leads through each cell.

Where the ratio is smallest, the distance may be nearly the same all over the cone's section. Then
the cone is inside of a thin wall, and meets no edge. So the ratio is divided by the slope of the
distance across the axis: 1 at an edge, but nearly 0 in the wall, which moves the edge far away.

Only rays that the march of the whole cone finds partly lit are split.
"""

from math import pi, sin, sqrt
from typing import Any

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitMask
from brdfkit.distance_fields.shadows.cone import LightCone
from brdfkit.distance_fields.shadows.edge import gradient_across_axis
from brdfkit.distance_fields.shadows.marches import make_convex_step, make_linear_rule
from brdfkit.distance_fields.shadows.shadow import Shadow, trace_shadow
from brdfkit.distance_fields.shadows.tau import lit_disc_share

FURTHEST_EDGE = 1e3  # the largest distance of an edge from its disc's centre, in radii


def compute_split_shadow(
    field: Any, cone: LightCone, epsilon: float = 1 / 20, direction: str = "A", rings: int = 1
) -> Shadow:
    """Return the mean shadow of 1 + 3 n (n + 1) narrower cones, with n `rings`: 7 for one ring.

    `r` and `t` of the result belong to the whole cone.
    """
    rule = make_linear_rule(epsilon)
    whole = trace_shadow(field, cone, rule, epsilon, direction, make_convex_step)
    partly = dr.abs(whole.r) < 1
    visible, evaluations = 0 * whole.r, whole.evaluations
    centres = cell_centres(rings)
    for x, y in centres:
        cell = make_cell_cone(cone, x, y, 1 / sqrt(len(centres)))
        shadow = trace_shadow(field, cell, rule, epsilon, direction, make_convex_step, partly)
        offset = shadow.r / slope_across_axis(field, cell, shadow, partly)
        visible = visible + lit_disc_share(offset) / len(centres)
        evaluations = evaluations + shadow.evaluations + dr.select(partly, 2, 0)
    return Shadow(dr.select(partly, visible, whole.visible), whole.r, whole.t, evaluations)


def slope_across_axis(field: Any, cone: LightCone, shadow: Shadow, active: JitMask) -> JitFloat:
    """Return the slope of the field across the axis where the ratio is smallest.

    It is 1 at an edge, and nearly 0 within a wall; it is 1, too, for rays that are not `active`. It
    has no derivatives.
    """
    cone = cone.make_detached()

    def clipped_slope(r: JitFloat, t: JitFloat) -> JitFloat:
        x, y = gradient_across_axis(field, cone, t, r * cone.radius(t))
        return dr.clip(dr.sqrt(x * x + y * y), 1 / FURTHEST_EDGE, 1)

    with dr.suspend_grad():
        r, t = dr.detach(shadow.r), dr.detach(shadow.t)
        return dr.if_stmt((r, t), active, clipped_slope, lambda r, t: 0 * t + 1)


def make_cell_cone(cone: LightCone, x: float, y: float, width: float) -> LightCone:
    """Return the cone around the ray at (x, y) whose radii are `width` times those of `cone`."""
    start, end = cone.disc_point(0 * cone.d, x, y), cone.disc_point(cone.d, x, y)
    d = dr.norm(end - start)
    return LightCone(start, (end - start) / d, d, cone.R_0 * width, cone.R_1 * width)


def cell_centres(rings: int) -> list[tuple[float, float]]:
    """Return the centroids (x, y) of a central disc, and of 6 k cells in the k-th ring about it.

    >>> len(cell_centres(2))
    19
    """
    count = 1 + 3 * rings * (rings + 1)
    centres = [(0.0, 0.0)]
    for k in range(1, rings + 1):
        inner, outer = (sqrt((1 + 3 * j * (j + 1)) / count) for j in (k - 1, k))
        half = pi / (6 * k)  # the angle [rad] from the middle of a cell to its side
        r = 2 / 3 * (outer**3 - inner**3) / (outer**2 - inner**2) * sin(half) / half
        angles = [2 * half * (i + k / 2) for i in range(6 * k)]
        centres += [(r * sin(angle + pi / 2), r * sin(angle)) for angle in angles]
    return centres
