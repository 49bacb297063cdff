"""`Shadow`, what every method returns; how a march becomes one, with derivatives.

The march is not differentiated. By the envelope theorem the derivative of a minimum is that of the
function at the place of the minimum, so f / ρ is evaluated there once more, with derivatives by
whatever moves: the light, its radius, the surface point, the parameters of the field. The march
stops looking within ε, so that the place is found more exactly first. Where nobody asks for
derivatives, none of this is part of the kernel.
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr

from brdfkit.distance_fields.shadows.field import distance_of
from brdfkit.distance_fields.shadows.march import cone_pace, march
from brdfkit.distance_fields.shadows.tau import tau

GOLDEN = (5**0.5 - 1) / 2


def ratio(field, cone, t):
    """f / ρ at t."""
    return distance_of(field)(cone.point(t)) / cone.radius(t)


def nearest_minimum(field, cone, t, width, steps):
    """The place of the minimum within `width` of t, by golden sections, without derivatives."""
    cone = cone.detached()

    def narrow(i, left, right):
        part = GOLDEN * (right - left)
        low, high = right - part, left + part
        lower = ratio(field, cone, low) < ratio(field, cone, high)
        return i + 1, dr.select(lower, left, low), dr.select(lower, high, right)

    with dr.suspend_grad():
        left, right = dr.maximum(t - width, 0), dr.minimum(t + width, cone.d)
        found = dr.while_loop((0 * t, left, right), lambda i, left, right: i < steps, narrow)
    _, left, right = found
    return (left + right) / 2


DIRECTIONS = "A", "B"  # from the surface to the light, or from the light to the surface
# Where the minimum may be about the smallest ratio of a march, over ε ρ: two steps or so
NEAR, REFINEMENTS = 4.0, 20
ASIDE = 1e-3  # from the minimum to its two sides, over ρ


@dataclass(frozen=True)
class Shadow:
    """How much of a light is seen, and by which ratio that was told.

    visible : Float, the share of the light that is seen, 0 to 1.
    r : Float, the smallest ratio f / ρ that was found, at most 1.
    t : Float, where on the axis it was found, from the surface point on.
    evaluations : Float, how often the distance was evaluated.
    """

    visible: Any
    r: Any
    t: Any
    evaluations: Any


def single_ray(field, cone, rule, epsilon, direction, pace=cone_pace, active=True):
    """The `Shadow` of one march by a `Rule`; rays that are not `active` are lit."""
    forward = direction == "A"
    walk = march(field, cone if forward else cone.reversed(), rule, epsilon, pace, active)
    d = dr.detach(cone.d)
    t = walk.t if forward else d - walk.t
    r = walk.R_T
    visible = dr.select(dr.isnan(r), r, tau(r))
    moving = moving_minimum(r, field, cone, t, epsilon)
    if dr.grad_enabled(moving):
        # τ' of what the march ends at, at most ε above the minimum, would be rough
        visible, r = dr.replace_grad(visible, tau(moving)), dr.replace_grad(r, moving)
    return Shadow(visible, r, t, walk.evaluations)


def moving_minimum(r, field, cone, t, epsilon):
    """The minimum of f / ρ near t, with derivatives where anything has them; `r` elsewhere.

    At a crease of the field they jump. There the derivative of the minimum is the mean of those on
    both sides, with the weights by which the slopes along the axis cancel.
    """

    def moving(t):
        return ratio(field, cone, t / dr.detach(cone.d) * cone.d)  # a fixed share of the axis

    if not dr.grad_enabled(moving(t)):
        return r
    with dr.suspend_grad():
        fixed = cone.detached()
        rho = fixed.radius(t)
        t = nearest_minimum(field, cone, t, NEAR * epsilon * rho, REFINEMENTS)
        before, left, right, behind = (
            dr.clip(t + k * ASIDE * rho, 0, fixed.d) for k in (-2, -1, 1, 2)
        )
        falls = dr.maximum(ratio(field, fixed, before) - ratio(field, fixed, left), 0)
        rises = dr.maximum(ratio(field, fixed, behind) - ratio(field, fixed, right), 0)
        level = falls + rises == 0
        weight = dr.select(level, 0.5, rises / dr.select(level, 1, falls + rises))
    return weight * moving(left) + (1 - weight) * moving(right)
