"""Searches along a ray: where a function first rises above 0, and where it is largest.

Functions f(t) take distances along rays. A ray is cut into `steps` equal parts between `near` and
`far`; what is thinner than a part may be missed. The searches have no derivatives.
"""

from collections.abc import Callable

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitInt, JitMask
from brdfkit.core.jit.loops import record_loops

HALVINGS = 8  # of a part: a crossing is then linear, and a largest value is found to 1/256 part


@record_loops
def find_first_above(
    f: Callable[[JitFloat], JitFloat], near: JitFloat, far: JitFloat, steps: int, active: JitMask
) -> tuple[JitInt, JitFloat, JitFloat]:
    """Find the first of `steps` + 1 even places from `near` to `far` where f is above 0.

    Returns its number, its distance and f there, which is not above 0 if there is no such place.
    """
    import mitsuba as mi

    step = (far - near) / steps

    def part(i: JitInt, t: JitFloat, above: JitFloat) -> tuple[JitInt, JitFloat, JitFloat]:
        t = near + mi.Float(i + 1) * step
        return i + 1, t, f(t)

    with dr.suspend_grad():
        return dr.while_loop(
            (mi.UInt32(0), mi.Float(near), mi.Float(f(near))),
            lambda i, t, above: active & (i < steps) & (above <= 0),
            part,
        )


@record_loops
def find_first_crossing(
    f: Callable[[JitFloat], JitFloat], near: JitFloat, far: JitFloat, steps: int, active: JitMask
) -> tuple[JitFloat, JitMask]:
    """Find the distance where f first rises above 0, and whether it does.

    The place of `find_first_above` is too deep by half a part on average. Here the part before it
    is halved, until less than 1e-6 of the ray is left. If f is above 0 at `near`, that is the
    distance. `reattach` gives the distance its derivatives.
    """
    import mitsuba as mi

    i, t, above = find_first_above(f, near, far, steps, active)
    found = active & (above > 0)
    refined = found & (i > 0)

    def halve(
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
            halve,
        )
        share = below / dr.select(refined, below - above, -1)
        return dr.select(refined, dr.lerp(outside, inside, share), t), found


def reattach(f: Callable[[JitFloat], JitFloat], t: JitFloat, slope: JitFloat) -> JitFloat:
    """Return the distance `t` of a crossing with its derivatives: dt = -df / slope.

    `slope` is df/dt at the crossing, without derivatives. Where it is not above 0, the ray grazes
    the surface, and t has no derivatives.
    """
    here = f(dr.detach(t))
    change = (here - dr.detach(here)) / dr.select(slope > 0, slope, 1)
    return t - dr.select(slope > 0, change, 0)


@record_loops
def find_largest(
    f: Callable[[JitFloat], JitFloat],
    near: JitFloat,
    far: JitFloat,
    steps: int,
    place: JitFloat,
    active: JitMask,
) -> JitFloat:
    """Find the distance from `near` to `far` at which f is largest.

    f is evaluated at both ends and in each part at the share `place` of it, then ever nearer on
    both sides of the largest value. The result is thus a value on the ray, never more than the
    largest. It needs no derivatives, as the largest value changes like the values at its place.
    """
    import mitsuba as mi

    step = (far - near) / steps

    def part(i: JitInt, best: JitFloat, largest: JitFloat) -> tuple[JitInt, JitFloat, JitFloat]:
        t = near + (mi.Float(i) + place) * step
        here = f(t)
        better = here > largest
        return i + 1, dr.select(better, t, best), dr.select(better, here, largest)

    def halve(i: JitInt, best: JitFloat, largest: JitFloat) -> tuple[JitInt, JitFloat, JitFloat]:
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
        _, best, largest = dr.while_loop(state, lambda i, *_: active & (i < steps), part)
        state = mi.UInt32(1), best, largest
        return dr.while_loop(state, lambda i, *_: active & (i <= HALVINGS), halve)[1]
