"""`split`: the cone cut into narrower ones, each with its own march and a straight edge of its own.

One straight edge is wrong for small and pointed occluders, and for several of them. So the disc is
cut into a centre and rings of 6, 12 ... cells of equal area, and a cone leads through each cell.
Where the section at the smallest ratio leaves f unchanged sideways, the cone has met a thin wall,
and not its edge: the edge is at the ratio over |∇f| across the axis, which the cell hardly reaches.

Only rays that the whole cone's own march finds partly lit are split.
"""

from math import pi, sin, sqrt

import drjit as dr

from brdfkit.distance_fields.shadows.cone import LightCone
from brdfkit.distance_fields.shadows.convex import convex_pace
from brdfkit.distance_fields.shadows.edge import gradient_across
from brdfkit.distance_fields.shadows.marches import linear_rule
from brdfkit.distance_fields.shadows.shadow import Shadow, single_ray
from brdfkit.distance_fields.shadows.tau import tau

STEEPEST = 1e3  # how far outside its disc an edge may lie


def split(field, cone, epsilon=1 / 20, direction="A", rings=1):
    """The `Shadow`: `visible` is the mean of 1 + 3 rings (rings + 1) narrower cones, 7 of one ring.

    `r` and `t` are those of the whole cone.
    """
    rule = linear_rule(epsilon)
    whole = single_ray(field, cone, rule, epsilon, direction, convex_pace)
    partly = dr.abs(whole.r) < 1
    visible, evaluations = 0 * whole.r, whole.evaluations
    places = cells(rings)
    for x, y in places:
        part = cell_cone(cone, x, y, 1 / sqrt(len(places)))
        found = single_ray(field, part, rule, epsilon, direction, convex_pace, partly)
        visible = visible + tau(found.r / steepness(field, part, found, partly)) / len(places)
        evaluations = evaluations + found.evaluations + dr.select(partly, 2, 0)
    return Shadow(dr.select(partly, visible, whole.visible), whole.r, whole.t, evaluations)


def steepness(field, cone, shadow, active):
    """|∇f| across the axis where `active`: 1 of an edge, 0 within a wall; without derivatives."""
    cone = cone.detached()

    def length(r, t):
        x, y = gradient_across(field, cone, t, r * cone.radius(t))
        return dr.clip(dr.sqrt(x * x + y * y), 1 / STEEPEST, 1)

    with dr.suspend_grad():
        r, t = dr.detach(shadow.r), dr.detach(shadow.t)
        return dr.if_stmt((r, t), active, length, lambda r, t: 0 * t + 1)


def cell_cone(cone, x, y, width):
    """The cone about the ray at (x, y), of this `width` over that of the whole one."""
    start, end = cone.across(0 * cone.d, x, y), cone.across(cone.d, x, y)
    d = dr.norm(end - start)
    return LightCone(start, (end - start) / d, d, cone.R_0 * width, cone.R_1 * width)


def cells(rings):
    """The centroids (x, y) of the cells: a disc, and rings of 6 k parts of annuli about it.

    >>> len(cells(2))
    19
    """
    count = 1 + 3 * rings * (rings + 1)
    places = [(0.0, 0.0)]
    for k in range(1, rings + 1):
        inner, outer = (sqrt((1 + 3 * j * (j + 1)) / count) for j in (k - 1, k))
        half = pi / (6 * k)  # the angle from the middle of a cell to its side
        r = 2 / 3 * (outer**3 - inner**3) / (outer**2 - inner**2) * sin(half) / half
        angles = [2 * half * (i + k / 2) for i in range(6 * k)]
        places += [(r * sin(angle + pi / 2), r * sin(angle)) for angle in angles]
    return places
