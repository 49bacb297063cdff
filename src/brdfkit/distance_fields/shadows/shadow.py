"""`Shadow`, the result of every method, and how a march becomes one, with derivatives.

The march itself is not differentiated. By the envelope theorem a minimum has the derivative of the
function at the minimum's place. So f / ρ is evaluated there once more, with derivatives by the
light, its radius, the surface point, and the parameters of the field. As the march ends
within ε of the minimum, the place is first refined. Where nothing carries derivatives, none of this
is part of the kernel.
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitMask
from brdfkit.distance_fields.shadows.cone import LightCone
from brdfkit.distance_fields.shadows.field import distance_of
from brdfkit.distance_fields.shadows.march import Pace, Rule, cone_pace, march
from brdfkit.distance_fields.shadows.tau import tau

DIRECTIONS = "A", "B"  # from the surface to the light, or from the light to the surface
GOLDEN_RATIO = (5**0.5 - 1) / 2
# The search for the exact minimum near a march's smallest ratio: its width over ε ρ, about two
# steps of the march, and its number of iterations
SEARCH_WIDTH, SEARCH_STEPS = 4.0, 20
SIDE_STEP = 1e-3  # the distance of the points on both sides of a minimum, over ρ


@dataclass(frozen=True)
class Shadow:
    """The visible share of a light, and the ratio that it was computed from.

    visible : Float, the share of the light that is visible, 0 to 1.
    r : Float, the smallest ratio f / ρ that was found, at most 1.
    t : Float, where on the axis it was found, from the surface point on.
    evaluations : Float, the number of evaluations of the distance.
    """

    visible: Any
    r: Any
    t: Any
    evaluations: Any


def ratio(field: Any, cone: LightCone, t: JitFloat) -> JitFloat:
    """Return f / ρ, the distance over the cone's radius, at the place t of the axis."""
    return distance_of(field)(cone.point(t)) / cone.radius(t)


def find_minimum_near(
    field: Any, cone: LightCone, t: JitFloat, width: JitFloat, steps: int
) -> JitFloat:
    """Return where `ratio` is smallest within `width` of t, by golden-section search.

    The result has no derivatives.
    """
    cone = cone.detached()

    def narrow(i: JitFloat, left: JitFloat, right: JitFloat) -> tuple[JitFloat, ...]:
        part = GOLDEN_RATIO * (right - left)
        low, high = right - part, left + part
        lower = ratio(field, cone, low) < ratio(field, cone, high)
        return i + 1, dr.select(lower, left, low), dr.select(lower, high, right)

    with dr.suspend_grad():
        left, right = dr.maximum(t - width, 0), dr.minimum(t + width, cone.d)
        start = (0 * t, left, right)
        _, left, right = dr.while_loop(start, lambda i, left, right: i < steps, narrow)
    return (left + right) / 2


def single_ray(
    field: Any,
    cone: LightCone,
    rule: Rule,
    epsilon: float,
    direction: str,
    pace: Pace = cone_pace,
    active: JitMask = True,
) -> Shadow:
    """Compute the shadow of one march by a `Rule`; rays that are not `active` are lit."""
    forward = direction == "A"
    walk = march(field, cone if forward else cone.reversed(), rule, epsilon, pace, active)
    d = dr.detach(cone.d)
    t = walk.t if forward else d - walk.t
    r = walk.R_T
    visible = dr.select(dr.isnan(r), r, tau(r))
    minimum = attach_minimum(r, field, cone, t, epsilon)
    if dr.grad_enabled(minimum):
        # The slope τ' at the march's last ratio, up to ε above the minimum, would be inexact
        attach: Any = dr.replace_grad  # Dr.Jit's own annotation says that it returns None
        visible, r = attach(visible, tau(minimum)), attach(r, minimum)
    return Shadow(visible, r, t, walk.evaluations)


def attach_minimum(
    r: JitFloat, field: Any, cone: LightCone, t: JitFloat, epsilon: float
) -> JitFloat:
    """Return the minimum of `ratio` near t, with derivatives; `r` if nothing carries derivatives.

    Derivatives jump at a crease of the field. The derivative of the minimum is then a mean of the
    derivatives on both sides, with weights that let the slopes along the axis cancel.
    """

    def moving_ratio(t: JitFloat) -> JitFloat:
        return ratio(field, cone, t / dr.detach(cone.d) * cone.d)  # t moves with the axis

    if not dr.grad_enabled(moving_ratio(t)):
        return r
    with dr.suspend_grad():
        fixed = cone.detached()
        rho = fixed.radius(t)
        t = find_minimum_near(field, cone, t, SEARCH_WIDTH * epsilon * rho, SEARCH_STEPS)
        before, left, right, behind = (
            dr.clip(t + k * SIDE_STEP * rho, 0, fixed.d) for k in (-2, -1, 1, 2)
        )
        falls = dr.maximum(ratio(field, fixed, before) - ratio(field, fixed, left), 0)
        rises = dr.maximum(ratio(field, fixed, behind) - ratio(field, fixed, right), 0)
        level = falls + rises == 0
        weight = dr.select(level, 0.5, rises / dr.select(level, 1, falls + rises))
    return weight * moving_ratio(left) + (1 - weight) * moving_ratio(right)
