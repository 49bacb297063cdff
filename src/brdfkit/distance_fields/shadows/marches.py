"""The single-ray methods `linear` (the default), `hard` and `convex`.

`linear` keeps the ratio R_C, below which its steps miss nothing, a constant below the smallest
ratio R_T so far; so τ is computed only once, at the end. `hard` does the same for a light of radius
0. `convex` takes longer steps in a union of convex objects. The distance f_j of a convex object is
a convex function, so that along the axis it lies above the line through its last two values. So the
cone with the radius R_C ρ cannot touch the object before

    Δt_j = (f_j - R_C ρ) / (R_C tan α - slope of that line)

The thesis proposes such steps without a formula. They hold within objects and where R_C < 0, too,
as the signed distance is convex there. See `march.py` for ratios and `cone.py` for ρ and α.

[Bálint et al. 2019, algorithm 4 and section 4.4]
"""

from math import pi
from typing import Any

import drjit as dr

from brdfkit.core.array_types import JitFloat
from brdfkit.distance_fields.shadows.cone import LightCone
from brdfkit.distance_fields.shadows.field import distance_of, lipschitz_of, pieces_of
from brdfkit.distance_fields.shadows.march import Rule, Step
from brdfkit.distance_fields.shadows.shadow import Shadow, single_ray


def linear(field: Any, cone: LightCone, epsilon: float = 1 / 20, direction: str = "A") -> Shadow:
    """Compute a shadow by the linear march, the default.

    The visible share is at most ε above τ(r_min), the exact share for the smallest ratio.
    """
    return single_ray(field, cone, linear_rule(epsilon), epsilon, direction)


def linear_rule(epsilon: float) -> Rule:
    """Return the rule of `linear`: no ratio more than e = ε π / 2 below the smallest is missed.

    A change of ε in the share τ(r) is a change of e in r at least, because τ' ≤ 2 / π.
    """
    e = epsilon * pi / 2
    return Rule((1.0, 1 - e), lambda ratio, R_T: (ratio, ratio - e), e - 1)


def hard(field: Any, cone: LightCone, epsilon: float = 1 / 20, direction: str = "A") -> Shadow:
    """Compute the shadow of `linear` for a light of radius 0."""
    return linear(field, cone.to_point(), epsilon, direction)


def convex(field: Any, cone: LightCone, epsilon: float = 1 / 20, direction: str = "A") -> Shadow:
    """Compute a shadow by longer steps towards convex pieces, with the error of `linear`.

    Pieces of a union that do not say `is_convex` are approached by the steps of `linear`.
    """
    return single_ray(field, cone, linear_rule(epsilon), epsilon, direction, convex_pace)


def convex_pace(field: Any, cone: LightCone) -> tuple[Step, Any]:
    """Return steps to the nearest piece; the memory is the last t and the distances there."""
    pieces = pieces_of(field)
    zero = 0 * cone.d

    def step(t: JitFloat, F: JitFloat, R_C: JitFloat, memory: Any) -> tuple[JitFloat, Any]:
        t_before, before = memory
        rho, tan = cone.radius(t), cone.tan
        now = tuple(distance_of(piece)(cone.point(t)) for piece in pieces)
        dt = cone.d
        for piece, f, f_before in zip(pieces, now, before, strict=True):
            clearance, lipschitz = f - R_C * rho, lipschitz_of(piece)
            closing = lipschitz + dr.abs(R_C * tan)
            if getattr(piece, "is_convex", False):
                line = dr.maximum((f - f_before) / (t - t_before), -lipschitz)
                closing = R_C * tan - line
            dt = dr.select(clearance >= dt * closing, dt, clearance / closing)
        return dt, (t, now)

    return step, (zero - 1, tuple(zero + dr.inf for _ in pieces))
