"""The march that single-ray shadows share: steps along the axis of a cone of light.

The smallest of the ratios f / ρ, the distance over the cone's radius, gives the share of the light
that comes through. The march keeps the smallest ratio so far, R_T, and a somewhat smaller one, R_C:
its steps are so short that it misses no ratio below R_C. Both may become negative, so that the
march goes on through objects.

[Bálint et al. 2019, algorithms 3-5]
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeAlias

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitMask
from brdfkit.distance_fields.shadows.cone import LightCone
from brdfkit.distance_fields.shadows.field import distance_of, lipschitz_of

# A function from (t, f, R_C, memory) to a step's length and the memory for the next step
Step: TypeAlias = Callable[[JitFloat, JitFloat, JitFloat, Any], tuple[JitFloat, Any]]
# A function from (field, cone) to the step function and its first memory
Pace: TypeAlias = Callable[[Any, LightCone], tuple[Step, Any]]


@dataclass(frozen=True)
class Rule:
    """The rule by which the smallest ratio R_T and its lower limit R_C follow a march.

    It distinguishes the methods.

    first : R_T and R_C at the start.
    lower : (ratio, R_T) → the new R_T and R_C, where a ratio is below R_T.
    last : the R_T at which hardly any light is left, and the march ends.
    """

    first: tuple[float, float]
    lower: Callable[[Any, Any], tuple[Any, Any]]
    last: float


@dataclass(frozen=True)
class Walk:
    """The result of a march: the smallest ratio R_T, its place t, and evaluations of f."""

    R_T: Any
    t: Any
    evaluations: Any


def cone_pace(field: Any, cone: LightCone) -> tuple[Step, tuple[()]]:
    """Return the steps of cone tracing: the ball about a point of the axis, less the cone's end."""
    lipschitz, tan = lipschitz_of(field), cone.tan

    def step(t: JitFloat, F: JitFloat, R_C: JitFloat, memory: Any) -> tuple[JitFloat, Any]:
        return (F - R_C * cone.radius(t)) / (lipschitz + dr.abs(R_C * tan)), memory

    return step, ()


def march(
    field: Any,
    cone: LightCone,
    rule: Rule,
    epsilon: float,
    pace: Pace = cone_pace,
    active: JitMask = True,
) -> Walk:
    """March from the start of the cone to its end, without derivatives, where `active`."""
    f, cone = distance_of(field), cone.detached()
    step, memory = pace(field, cone)
    max_steps = cone.max_steps(epsilon, lipschitz_of(field))

    def one_step(
        t: JitFloat, R_T: JitFloat, R_C: JitFloat, t_min: JitFloat, i: JitFloat, memory: Any
    ) -> tuple[Any, ...]:
        F, rho = f(cone.point(t)), cone.radius(t)
        nearer = R_T * rho > F
        lower_T, lower_C = rule.lower(F / rho, R_T)
        R_T, R_C = dr.select(nearer, lower_T, R_T), dr.select(nearer, lower_C, R_C)
        dt, memory = step(t, F, R_C, memory)
        return t + dt, R_T, R_C, dr.select(nearer, t, t_min), i + 1, memory

    with dr.suspend_grad():
        zero = 0 * cone.d
        R_T, R_C = (zero + R for R in rule.first)
        t, R_T, _, t_min, i, _ = dr.while_loop(
            (zero, R_T, R_C, zero, zero, memory),
            lambda t, R_T, R_C, t_min, i, memory: (
                active & (t < cone.d) & (rule.last < R_T) & (i < max_steps)
            ),
            one_step,
        )
    return Walk(dr.select(dr.isnan(t), dr.nan, R_T), t_min, i)  # R_T is NaN where the field is
