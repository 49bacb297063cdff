"""The single-ray methods `linear` (the default), `hard` and `convex`.

The steps of `linear` miss no ratio below the limit R_C, which stays a constant below the smallest
ratio R_T so far. So the lit share τ is computed only once, at the end. `hard` does the same for a
light of radius 0.

`convex` takes longer steps in a union of convex objects. The distance f_j of a convex object is a
convex function: along the axis it lies above the line through its last two values. So the cone
with the radius R_C ρ cannot touch the object before the march has gone on by

    Δt_j = (f_j - R_C ρ) / (R_C tan α - slope of that line)

The thesis proposes such steps without a formula. They are safe within objects and where R_C < 0,
too, as the signed distance is convex there. See `march.py` for ratios and `cone.py` for ρ and α.

[Bálint et al. 2019, algorithm 4 and section 4.4]
"""

from math import pi
from typing import Any

import drjit as dr

from brdfkit.core.array_types import JitFloat
from brdfkit.distance_fields.shadows.cone import LightCone
from brdfkit.distance_fields.shadows.field import (
    distance_function,
    lipschitz_bound,
    split_into_pieces,
)
from brdfkit.distance_fields.shadows.march import Rule, Step
from brdfkit.distance_fields.shadows.shadow import Shadow, trace_shadow


def compute_linear_shadow(
    field: Any, cone: LightCone, epsilon: float = 1 / 20, direction: str = "A"
) -> Shadow:
    """Return a soft shadow by the linear march, the default method.

    For an occluder with a straight edge, the visible share is at most `epsilon` too large.
    """
    return trace_shadow(field, cone, make_linear_rule(epsilon), epsilon, direction)


def make_linear_rule(epsilon: float) -> Rule:
    """Return the rule of the linear march, whose lit share has at most the error ε = `epsilon`.

    A change of ε in the lit share τ(r) of the ratio r is a change of at least e = ε π / 2 in r,
    because τ' ≤ 2 / π. So no ratio more than e below the smallest one may be missed.
    """
    e = epsilon * pi / 2
    return Rule((1.0, 1 - e), lambda ratio, R_T: (ratio, ratio - e), e - 1)


def compute_hard_shadow(
    field: Any, cone: LightCone, epsilon: float = 1 / 20, direction: str = "A"
) -> Shadow:
    """Return the shadow of a light of radius 0, by the linear march."""
    return compute_linear_shadow(field, cone.narrow_to_centre(), epsilon, direction)


def compute_convex_shadow(
    field: Any, cone: LightCone, epsilon: float = 1 / 20, direction: str = "A"
) -> Shadow:
    """Return a soft shadow by longer steps towards convex pieces, as exact as the linear march.

    Pieces of a union without `is_convex` are approached by the steps of the linear march. `epsilon`
    bounds the error of the smallest ratio of clearance to the cone's radius. The march begins at
    the shaded point (`direction` "A") or at the light ("B").
    """
    rule = make_linear_rule(epsilon)
    return trace_shadow(field, cone, rule, epsilon, direction, make_convex_step)


def make_convex_step(field: Any, cone: LightCone) -> tuple[Step, Any]:
    """Return a function for steps towards convex pieces, and its first memory.

    The memory is the last t and the distances of all pieces there.
    """
    pieces = split_into_pieces(field)
    zero = 0 * cone.d

    def choose_step(t: JitFloat, F: JitFloat, R_C: JitFloat, memory: Any) -> tuple[JitFloat, Any]:
        t_before, before = memory
        rho, tan = cone.radius(t), cone.tan
        now = tuple(distance_function(piece)(cone.point(t)) for piece in pieces)
        dt = cone.d
        for piece, f, f_before in zip(pieces, now, before, strict=True):
            clearance, lipschitz = f - R_C * rho, lipschitz_bound(piece)
            closing = lipschitz + dr.abs(R_C * tan)
            if getattr(piece, "is_convex", False):
                line = dr.maximum((f - f_before) / (t - t_before), -lipschitz)
                closing = R_C * tan - line
            dt = dr.select(clearance >= dt * closing, dt, clearance / closing)
        return dt, (t, now)

    return choose_step, (zero - 1, tuple(zero + dr.inf for _ in pieces))
