"""`convex`: longer steps where the field is a union of convex objects.

The distance f_j of a convex object is a convex function. Along the axis it lies above the line
through its last two values, so that the cone cannot touch the object before

    Δt_j = (f_j - R_C ρ) / (R_C tan α - slope of that line)

The thesis asks for such steps and leaves the formula open. They may also be taken within objects,
and where R_C < 0: the signed distance is convex there, too.

[Bálint et al. 2019, section 4.4]
"""

import drjit as dr

from brdfkit.distance_fields.shadows.field import distance_of, lipschitz_of, pieces_of
from brdfkit.distance_fields.shadows.marches import linear_rule
from brdfkit.distance_fields.shadows.shadow import single_ray


def convex(field, cone, epsilon=1 / 20, direction="A"):
    """The `Shadow`: 0 ≤ visible - τ(r_min) ≤ ε.

    The pieces of a union that say `is_convex` let the march run; all others are stepped up to by
    `linear`'s steps.
    """
    return single_ray(field, cone, linear_rule(epsilon), epsilon, direction, convex_pace)


def convex_pace(field, cone):
    """Steps up to the nearest piece; the memory is the last t, and the distances there."""
    pieces = pieces_of(field)
    zero = 0 * cone.d

    def step(t, F, R_C, memory):
        t_before, before = memory
        rho, tan = cone.radius(t), cone.tan
        now = tuple(distance_of(piece)(cone.point(t)) for piece in pieces)
        dt = cone.d
        for piece, f, f_before in zip(pieces, now, before, strict=True):
            room, lipschitz = f - R_C * rho, lipschitz_of(piece)
            closing = lipschitz + dr.abs(R_C * tan)
            if getattr(piece, "is_convex", False):
                line = dr.maximum((f - f_before) / (t - t_before), -lipschitz)
                closing = R_C * tan - line
            dt = dr.select(room >= dt * closing, dt, room / closing)
        return dt, (t, now)

    return step, (zero - 1, tuple(zero + dr.inf for _ in pieces))
