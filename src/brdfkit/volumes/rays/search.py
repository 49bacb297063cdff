"""Searches along rays: for the distance at which a function exceeds 0, and for its maximum.

A function f(t) takes distances t along rays. Between `near` and `far` it is evaluated at equal
steps, so that features thinner than a step may be missed. The searches have no derivatives.
"""

from collections.abc import Callable

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitInt, JitMask
from brdfkit.core.jit.loops import record_loops

HALVINGS = 8  # how often the step around a crossing or maximum is halved, to 1/256 of it


@record_loops
def find_first_positive_step(
    f: Callable[[JitFloat], JitFloat], near: JitFloat, far: JitFloat, steps: int, active: JitMask
) -> tuple[JitInt, JitFloat, JitFloat]:
    """Find the first of `steps` + 1 equally spaced distances from `near` to `far` where f > 0.

    Returns its number from 0, the distance, and the value of f there. If f is nowhere above 0, they
    are those of the last distance.
    """
    import mitsuba as mi

    step = (far - near) / steps

    def step_ahead(i: JitInt, t: JitFloat, above: JitFloat) -> tuple[JitInt, JitFloat, JitFloat]:
        t = near + mi.Float(i + 1) * step
        return i + 1, t, f(t)

    with dr.suspend_grad():
        return dr.while_loop(
            (mi.UInt32(0), mi.Float(near), mi.Float(f(near))),
            lambda i, t, above: active & (i < steps) & (above <= 0),
            step_ahead,
        )


@record_loops
def find_first_crossing(
    f: Callable[[JitFloat], JitFloat], near: JitFloat, far: JitFloat, steps: int, active: JitMask
) -> tuple[JitFloat, JitMask]:
    """Find the distance at which f first rises above 0; return also a mask of rays where it does.

    The step before the first value above 0 is halved `HALVINGS` times, then the crossing is
    interpolated linearly. If f is above 0 at `near` already, the distance is `near`.
    `attach_crossing_derivatives` gives the distance its derivatives.
    """
    import mitsuba as mi

    i, t, above = find_first_positive_step(f, near, far, steps, active)
    found = active & (above > 0)
    refined = found & (i > 0)

    def halve_step(
        n: JitInt, outside: JitFloat, inside: JitFloat, below: JitFloat, above: JitFloat
    ) -> tuple[JitInt, JitFloat, JitFloat, JitFloat, JitFloat]:
        t = (outside + inside) / 2
        here = f(t)
        deep = here > 0
        outside, below = dr.select(deep, outside, t), dr.select(deep, below, here)
        inside, above = dr.select(deep, t, inside), dr.select(deep, here, above)
        return n + 1, outside, inside, below, above

    with dr.suspend_grad():
        before = t - (far - near) / steps
        _, outside, inside, below, above = dr.while_loop(
            (mi.UInt32(0), before, t, f(before), above),
            lambda n, *_: refined & (n < HALVINGS),
            halve_step,
        )
        share = below / dr.select(refined, below - above, -1)
        return dr.select(refined, dr.lerp(outside, inside, share), t), found


def attach_crossing_derivatives(
    f: Callable[[JitFloat], JitFloat], t: JitFloat, slope: JitFloat
) -> JitFloat:
    """Return the distance `t` at which f crosses 0 with its derivatives: dt = -df / slope.

    df is the change of f at a constant t. `slope` is df/dt at the crossing, without derivatives.
    Where it is 0 or less, the ray grazes the surface f = 0, and t gets no derivatives.
    """
    here = f(dr.detach(t))
    change = (here - dr.detach(here)) / dr.select(slope > 0, slope, 1)
    return t - dr.select(slope > 0, change, 0)


@record_loops
def find_distance_of_maximum(
    f: Callable[[JitFloat], JitFloat],
    near: JitFloat,
    far: JitFloat,
    steps: int,
    place: JitFloat,
    active: JitMask,
) -> JitFloat:
    """Find the distance from `near` to `far` at which f is largest.

    f is evaluated at both ends, and once in each step: where `place`, from 0 to 1, is in the step.
    Then the surroundings of the largest value are searched at ever smaller distances. The distance
    needs no derivatives: the derivative of a maximum is that of f at a constant distance.
    """
    import mitsuba as mi

    step = (far - near) / steps

    def sample_step(
        i: JitInt, best: JitFloat, largest: JitFloat
    ) -> tuple[JitInt, JitFloat, JitFloat]:
        t = near + (mi.Float(i) + place) * step
        here = f(t)
        better = here > largest
        return i + 1, dr.select(better, t, best), dr.select(better, here, largest)

    def search_nearby(
        i: JitInt, best: JitFloat, largest: JitFloat
    ) -> tuple[JitInt, JitFloat, JitFloat]:
        reach = step * dr.exp2(-mi.Float(i))
        for side in (-1, 1):
            t = dr.clip(best + side * reach, near, far)
            here = f(t)
            better = here > largest
            best, largest = dr.select(better, t, best), dr.select(better, here, largest)
        return i + 1, best, largest

    with dr.suspend_grad():
        ends = f(near), f(far)
        state = mi.UInt32(0), dr.select(ends[0] > ends[1], near, far), dr.maximum(*ends)
        _, best, largest = dr.while_loop(state, lambda i, *_: active & (i < steps), sample_step)
        state = mi.UInt32(1), best, largest
        return dr.while_loop(state, lambda i, *_: active & (i <= HALVINGS), search_nearby)[1]
