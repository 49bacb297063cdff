"""The march that single-ray shadows share: a cone of shrinking relative radius along the axis.

The smallest of the ratios f / ρ, the distance over the cone's radius, says how much light comes
through. R_T is the smallest so far; steps are so short that no ratio below R_C, which lies a little
lower, is missed. Both may become negative, so that the march goes on through objects.

[Bálint et al. 2019, algorithms 3-5]
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import drjit as dr

from brdfkit.distance_fields.shadows.field import distance_of, lipschitz_of


@dataclass(frozen=True)
class Rule:
    """How R_T and R_C follow the ratios: what tells the methods of shadows apart.

    first : R_T and R_C at the start.
    lower : (ratio, R_T) → the new R_T and R_C, where a ratio is below R_T.
    last : the R_T at which hardly any light is left, and the march ends.
    """

    first: tuple[float, float]
    lower: Callable[[Any, Any], tuple[Any, Any]]
    last: float


@dataclass(frozen=True)
class Walk:
    """What a march found: R_T, the t at which it became so, and the number of evaluations of f."""

    R_T: Any
    t: Any
    evaluations: Any


def cone_pace(field, cone):
    """The steps of cone tracing: the ball about a point of the axis, less the cone at its end."""
    lipschitz, tan = lipschitz_of(field), cone.tan

    def step(t, F, R_C, memory):
        return (F - R_C * cone.radius(t)) / (lipschitz + dr.abs(R_C * tan)), memory

    return step, ()


def march(field, cone, rule, epsilon, pace=cone_pace, active=True):
    """The `Walk` from the start of the cone to its end, without derivatives.

    `pace(field, cone)` gives the function `step(t, F, R_C, memory)`, which returns the length of a
    step and what it remembers for the next one, and the first memory.
    """
    f, cone = distance_of(field), cone.detached()
    step, memory = pace(field, cone)
    most = cone.most_steps(epsilon, lipschitz_of(field))

    def going_on(t, R_T, R_C, t_min, i, memory):
        return active & (t < cone.d) & (rule.last < R_T) & (i < most)

    def one_step(t, R_T, R_C, t_min, i, memory):
        F, rho = f(cone.point(t)), cone.radius(t)
        nearer = R_T * rho > F
        lower_T, lower_C = rule.lower(F / rho, R_T)
        R_T, R_C = dr.select(nearer, lower_T, R_T), dr.select(nearer, lower_C, R_C)
        dt, memory = step(t, F, R_C, memory)
        return t + dt, R_T, R_C, dr.select(nearer, t, t_min), i + 1, memory

    with dr.suspend_grad():
        zero = 0 * cone.d
        R_T, R_C = (zero + R for R in rule.first)
        found = dr.while_loop((zero, R_T, R_C, zero, zero, memory), going_on, one_step)
    t, R_T, _, t_min, i, _ = found
    return Walk(dr.select(dr.isnan(t), dr.nan, R_T), t_min, i)  # NaN where the field was
