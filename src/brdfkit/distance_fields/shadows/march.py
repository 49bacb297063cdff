"""The march that single-ray shadows share: steps along the axis of a cone to the light.

The smallest of the ratios f / ρ, the distance over the cone's radius, gives the share of the light
that comes through. The march keeps the smallest ratio so far, R_T, and a somewhat smaller limit
R_C: its steps are so short that it misses no ratio below R_C. Both may become negative, so that the
march goes on through objects.

[Bálint et al. 2019, algorithms 3-5]
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeAlias

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitMask
from brdfkit.distance_fields.shadows.cone import LightCone
from brdfkit.distance_fields.shadows.field import distance_function, lipschitz_bound

# A function from (t, f, R_C, memory) to the length of a step and the memory for the next step. t is
# a distance along the axis, f the field there, and R_C the limit of ratios; the memory is whatever
# the function wants to know of earlier steps
Step: TypeAlias = Callable[[JitFloat, JitFloat, JitFloat, Any], tuple[JitFloat, Any]]
# A function from (field, cone) to a step function and its first memory
Pace: TypeAlias = Callable[[Any, LightCone], tuple[Step, Any]]


@dataclass(frozen=True)
class Rule:
    """How a march lowers R_T, the smallest ratio found so far, and R_C, the limit of ratios.

    A ratio is the distance over the cone's radius. The steps of the march are so short that it
    misses no ratio below R_C. The methods of single-ray shadows differ in this rule.

    first : R_T and R_C at the start.
    lower : function that takes a ratio below R_T, and R_T, and returns the new R_T and R_C.
    last : the R_T at which hardly any light is left, and the march ends.
    """

    first: tuple[float, float]
    lower: Callable[[Any, Any], tuple[Any, Any]]
    last: float


@dataclass(frozen=True)
class Walk:
    """The result of a march along a cone.

    R_T : the smallest ratio of distance to cone radius that it found.
    t : the distance along the axis at which it found this ratio.
    before, after : the distances one step before and after t, or t itself where there is none.
    evaluations : the number of evaluations of the distance.
    """

    R_T: Any
    t: Any
    before: Any
    after: Any
    evaluations: Any


def make_cone_tracing_step(field: Any, cone: LightCone) -> tuple[Step, tuple[()]]:
    """Return a function for the steps of cone tracing, and its memory, which is empty.

    A step leads as far as no ratio of distance to cone radius can be below the limit R_C.
    """
    lipschitz, tan = lipschitz_bound(field), cone.tan

    def choose_step(t: JitFloat, F: JitFloat, R_C: JitFloat, memory: Any) -> tuple[JitFloat, Any]:
        return (F - R_C * cone.radius(t)) / (lipschitz + dr.abs(R_C * tan)), memory

    return choose_step, ()


def march_along_cone(
    field: Any,
    cone: LightCone,
    rule: Rule,
    epsilon: float,
    pace: Pace = make_cone_tracing_step,
    active: JitMask = True,
    to_the_end: bool = False,
) -> Walk:
    """March from the start of a cone to its end, and return the smallest ratio on the way.

    A ratio is the distance over the cone's radius. The result has no derivatives.

    rule : the rule by which the smallest ratio and its limit are updated.
    epsilon : error of the lit share, which bounds the number of steps.
    pace : function that makes the function for the steps.
    active : whether each ray marches at all.
    to_the_end : whether rays that are nearly dark go on as long as any light is left, as is needed
        for derivatives.
    """
    f, cone = distance_function(field), cone.make_detached()
    step, memory = pace(field, cone)
    max_steps = cone.bound_step_count(epsilon, lipschitz_bound(field))
    last = -1.0 if to_the_end else rule.last

    def take_step(
        t: JitFloat,
        R_T: JitFloat,
        R_C: JitFloat,
        place: tuple[JitFloat, ...],
        t_before: JitFloat,
        i: JitFloat,
        memory: Any,
    ) -> tuple[Any, ...]:
        F, rho = f(cone.point(t)), cone.radius(t)
        nearer = R_T * rho > F
        lower_T, lower_C = rule.lower(F / rho, R_T)
        R_T, R_C = dr.select(nearer, lower_T, R_T), dr.select(nearer, lower_C, R_C)
        dt, memory = step(t, F, R_C, memory)
        here = t, t_before, t + dt
        place = tuple(dr.select(nearer, new, old) for new, old in zip(here, place, strict=True))
        return t + dt, R_T, R_C, place, t, i + 1, memory

    with dr.suspend_grad():
        zero = 0 * cone.d
        R_T, R_C = (zero + R for R in rule.first)
        t, R_T, _, place, _, i, _ = dr.while_loop(
            (zero, R_T, R_C, (zero, zero, zero), zero, zero, memory),
            lambda t, R_T, R_C, place, t_before, i, memory: (
                active & (t < cone.d) & (last < R_T) & (i < max_steps)
            ),
            take_step,
        )
    # A field that is not a number makes t NaN, but not R_T
    return Walk(dr.select(dr.isnan(t), dr.nan, R_T), *place, i)
