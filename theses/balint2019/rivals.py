"""Defines soft shadows that are slower or less exact than the default `linear`, to compare with it.

`base` and `discrete` are the thesis's other marches, `quilez` and `aaltonen` formulas known from
games. `soft_shadow` and the integrator `distance_field` load them when their names are chosen.

[Bálint et al. 2019, algorithms 3 and 5]; [Quílez 2010]
"""

from collections.abc import Callable
from typing import Any

import drjit as dr

from brdfkit.core.array_types import JitFloat
from brdfkit.distance_fields.shadows.cone import LightCone
from brdfkit.distance_fields.shadows.field import distance_function, lipschitz_bound
from brdfkit.distance_fields.shadows.march import Rule
from brdfkit.distance_fields.shadows.shadow import Shadow, trace_shadow
from brdfkit.distance_fields.shadows.tau import lit_disc_share

NEWTON_STEPS = 4  # for errors below 1e-14, and below 1e-6 in single precision
MAX_STEPS = 512  # of a hard ray
# Of a hard ray from an object that it meets: at most this share of the light's distance, and
# half of the empty ball's radius at most, so that no ray meets the surface where it starts
HIT_DISTANCE = 1e-3


def base(field: Any, cone: LightCone, epsilon: float = 1 / 20, direction: str = "A") -> Shadow:
    """Compute a shadow by the basic march, with a share from τ(r_min) to ε above it.

    τ(r_min) is the share that the model of one straight edge gives.
    """

    def lower(ratio: JitFloat, R_T: JitFloat) -> tuple[JitFloat, JitFloat]:
        return ratio, invert_tau(lit_disc_share(ratio) - epsilon)

    rule = Rule((1.0, invert_tau(1 - epsilon)), lower, invert_tau(epsilon))
    return trace_shadow(field, cone, rule, epsilon, direction)


def discrete(field: Any, cone: LightCone, epsilon: float = 1 / 20, direction: str = "A") -> Shadow:
    """Compute a shadow in levels that are multiples of ε: |visible - τ(r_min)| ≤ ε.

    The result's `t` is where the march reached the last level, perhaps far from the minimum, so
    that its derivatives are rough.
    """

    def lower(ratio: JitFloat, R_T: JitFloat) -> tuple[JitFloat, JitFloat]:
        """Go down one level, or several where the light itself lies within an object."""
        levels = dr.maximum(dr.ceil((lit_disc_share(R_T) - lit_disc_share(ratio)) / epsilon - 1), 1)
        share = lit_disc_share(R_T) - levels * epsilon
        return invert_tau(share), invert_tau(share - epsilon)

    rule = Rule((1.0, invert_tau(1 - epsilon)), lower, invert_tau(epsilon))
    return trace_shadow(field, cone, rule, epsilon, direction)


def invert_tau(share: JitFloat) -> JitFloat:
    """Return the r with τ(r) = `share`, which is clamped to [0, 1].

    The thesis bisects, because Newton's steps for τ are divisions by 0 at both ends. But with r =
    ±cos(y/2) the equation is y - sin y = π - π |2 share - 1|, convex in y ≥ 0: four Newton steps
    from the root of y³/6, which is exact at the ends, reach the last digit. Forty bisections made
    `base` 15 times as slow as `linear`.

    >>> round(invert_tau(0.75), 9)
    0.403972753
    """
    side = 2 * dr.clip(share, 0, 1) - 1
    c = dr.pi * (1 - dr.abs(side))
    y = dr.cbrt(6 * c)
    for _ in range(NEWTON_STEPS):
        sin, cos = dr.sincos(y)
        y = y - (y - sin - c) / dr.maximum(1 - cos, 1e-30)
    return dr.copysign(dr.cos(y / 2), side)


def quilez(field: Any, cone: LightCone) -> Shadow:
    """Compute a shadow as the smallest k f / t along a ray, for distances f at t.

    The light's hardness is k = d / R_1, its distance over its radius [Quílez 2010].
    """

    def compute_nearness(t: JitFloat, F: JitFloat, F_before: JitFloat) -> JitFloat:
        return F / t

    return trace_hard_ray(field, cone, compute_nearness)


def aaltonen(field: Any, cone: LightCone) -> Shadow:
    """Compute a shadow as the smallest k √(f² - y²) / (t - y), with y = f² / (2 f before).

    It is Aaltonen's improvement of `quilez`, by the distances f at two steps along a ray.
    """

    def compute_nearness(t: JitFloat, F: JitFloat, F_before: JitFloat) -> JitFloat:
        y = F * F / (2 * F_before)
        return dr.safe_sqrt(F * F - y * y) / dr.maximum(t - y, 1e-6 * t)

    return trace_hard_ray(field, cone, compute_nearness)


def trace_hard_ray(
    field: Any, cone: LightCone, nearness: Callable[[JitFloat, JitFloat, JitFloat], JitFloat]
) -> Shadow:
    """Compute the shadow of a hard ray by the smallest distance at which it passes objects.

    The ray ends where it meets an object, so that the inner half of the penumbra is black.
    `nearness(t, F, F_before)` is the distance at which it passes, over t.
    """
    f, lipschitz, cone = (distance_function(field), lipschitz_bound(field), cone.make_detached())
    k, hit = cone.d / cone.R_1, dr.minimum(HIT_DISTANCE * cone.d, cone.R_0 / 2)

    def step(
        t: JitFloat, visible: JitFloat, t_min: JitFloat, F_before: JitFloat, i: JitFloat
    ) -> tuple[JitFloat, ...]:
        F = f(cone.point(t))
        near = dr.select(hit > F, 0, k * nearness(t, F, F_before))
        t_min = dr.select(near < visible, t, t_min)
        return t + F / lipschitz, dr.minimum(visible, near), t_min, F, i + 1

    with dr.suspend_grad():
        zero = 0 * cone.d
        start = dr.maximum(cone.R_0, hit)  # off the surface, where the distance is 0
        _, visible, t_min, _, i = dr.while_loop(
            (start, zero + 1, zero, zero + 1e20, zero),
            lambda t, visible, t_min, F, i: (t < cone.d) & (visible > 0) & (i < MAX_STEPS),
            step,
        )
    return Shadow(visible, visible, t_min, i)
