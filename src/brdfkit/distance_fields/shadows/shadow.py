"""`Shadow`, the result of every method, and how a march becomes one, with derivatives.

The march itself is not differentiated. It finds where on the cone's axis f / ρ is smallest, the
distance to the surface over the cone's radius. By the envelope theorem, the derivative of this
minimum is that of f / ρ at a fixed point of the axis. So f / ρ is evaluated there once more, with
derivatives with respect to the light, its radius, the surface point, and the parameters of the
field. The march passes within ε of the minimum, so its point is refined first, between the steps
before and after it; a march from the light does not quite reach the surface point, which is tried,
too. Rays that are nearly dark are followed to full darkness, as τ is steep where they would end
else. Where nothing carries derivatives, none of this is part of the kernel.
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitMask
from brdfkit.core.jit.gradients import replace_grad
from brdfkit.distance_fields.shadows.cone import LightCone
from brdfkit.distance_fields.shadows.field import distance_function
from brdfkit.distance_fields.shadows.march import (
    Pace,
    Rule,
    make_cone_tracing_step,
    march_along_cone,
)
from brdfkit.distance_fields.shadows.tau import lit_disc_share

DIRECTIONS = "A", "B"  # A marches from the surface to the light, B from the light to the surface
GOLDEN_RATIO = (5**0.5 - 1) / 2
# Iterations of the golden-section search for the exact minimum near the smallest ratio of a march
SEARCH_STEPS = 24
SIDE_STEP = 1e-3  # the distance from a minimum to the points beside it, in radii of the cone


@dataclass(frozen=True)
class Shadow:
    """The visible share of a light, and the ratio from which it was computed.

    visible : Float, the share of the light that is visible, 0 to 1.
    r : Float, the smallest ratio of distance to cone radius that was found, at most 1.
    t : Float, where on the axis it was found, as a distance from the surface point.
    evaluations : Float, the number of evaluations of the distance.
    """

    visible: Any
    r: Any
    t: Any
    evaluations: Any


def clearance_ratio(field: Any, cone: LightCone, t: JitFloat) -> JitFloat:
    """Return the field's distance over the cone's radius, at the distance t along the axis."""
    return distance_function(field)(cone.point(t)) / cone.radius(t)


def find_smallest_ratio(
    field: Any, cone: LightCone, t: JitFloat, width: JitFloat, steps: int
) -> JitFloat:
    """Return where the clearance ratio is smallest within `width` of t, by golden-section search.

    The result has no derivatives.
    """
    cone = cone.make_detached()

    def narrow_interval(i: JitFloat, left: JitFloat, right: JitFloat) -> tuple[JitFloat, ...]:
        part = GOLDEN_RATIO * (right - left)
        low, high = right - part, left + part
        lower = clearance_ratio(field, cone, low) < clearance_ratio(field, cone, high)
        return i + 1, dr.select(lower, left, low), dr.select(lower, high, right)

    with dr.suspend_grad():
        left, right = dr.maximum(t - width, 0), dr.minimum(t + width, cone.d)
        start = (0 * t, left, right)
        _, left, right = dr.while_loop(start, lambda i, left, right: i < steps, narrow_interval)
    return (left + right) / 2


def trace_shadow(
    field: Any,
    cone: LightCone,
    rule: Rule,
    epsilon: float,
    direction: str,
    pace: Pace = make_cone_tracing_step,
    active: JitMask = True,
) -> Shadow:
    """Return the shadow that one march along a cone finds; rays that are not `active` are lit.

    rule, pace : rule and step function of the march, by which methods differ.
    """
    forward = direction == "A"
    path = cone if forward else cone.make_reversed()
    settings = field, path, rule, epsilon, pace, active
    walk = march_along_cone(*settings)
    # Asked at the march's own end, because Dr.Jit drops derivatives that are 0 at a constant point
    differentiable = dr.grad_enabled(clearance_ratio(field, path, walk.t))
    if differentiable:
        walk = march_along_cone(*settings, to_the_end=True)  # the first one is not run
    d = dr.detach(cone.d)
    t, before, after = (t if forward else d - t for t in (walk.t, walk.before, walk.after))
    r = walk.R_T
    visible = dr.select(dr.isnan(r), r, lit_disc_share(r))
    if differentiable:
        # The derivatives are taken at the exact minimum: the march's own ratio r is a little above
        # it, where the slope of `lit_disc_share` is another
        minimum = compute_smallest_ratio(field, cone, before, after)
        visible, r = replace_grad(visible, lit_disc_share(minimum)), replace_grad(r, minimum)
    return Shadow(visible, r, t, walk.evaluations)


def compute_smallest_ratio(
    field: Any, cone: LightCone, before: JitFloat, after: JitFloat
) -> JitFloat:
    """Return the smallest clearance ratio between two points of the axis, with derivatives.

    The start of the axis is tried, too. Derivatives jump at a crease of the field. The derivative
    of the minimum is then a mean of the derivatives on both sides, with weights that let the slopes
    along the axis cancel.
    """

    def moving_ratio(t: JitFloat) -> JitFloat:
        # If the axis grows longer, its point t moves along, at the same share of the length
        return clearance_ratio(field, cone, t / dr.detach(cone.d) * cone.d)

    with dr.suspend_grad():
        fixed = cone.make_detached()
        middle, width = (before + after) / 2, dr.abs(after - before) / 2
        t = find_smallest_ratio(field, fixed, middle, width, SEARCH_STEPS)
        at_start = clearance_ratio(field, fixed, 0 * t) < clearance_ratio(field, fixed, t)
        t = dr.select(at_start, 0, t)
        rho = fixed.radius(t)
        places = [dr.clip(t + k * SIDE_STEP * rho, 0, fixed.d) for k in (-2, -1, 1, 2)]
        first, at_left, at_right, last = (clearance_ratio(field, fixed, t) for t in places)
        falls, rises = dr.maximum(first - at_left, 0), dr.maximum(last - at_right, 0)
        level = falls + rises == 0
        weight = dr.select(level, 0.5, rises / dr.select(level, 1, falls + rises))
    return weight * moving_ratio(places[1]) + (1 - weight) * moving_ratio(places[2])
