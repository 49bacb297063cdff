"""Where along a ray the largest value lies."""

import drjit as dr

from brdfkit.core.jit.loops import record_loops

HALVINGS = 8  # of a step: its place is found to 1/256 of one, its value still nearer


@record_loops
def largest_along(value, near, far, steps, place, active):
    """The distance from `near` to `far` at which `value(t)` is largest.

    One value is asked for at both ends, and in each of `steps` equal parts at the share `place` of
    it; then nearer and nearer on both sides of the largest. So what is narrower than a part may be
    missed, and what is found is a value on the ray, never more than the largest. Nothing has
    derivatives here: the largest value changes as the values at its place do.
    """
    import mitsuba as mi

    step = (far - near) / steps

    def part(i, best, largest):
        t = near + (mi.Float(i) + place) * step
        here = value(t)
        better = here > largest
        return i + 1, dr.select(better, t, best), dr.select(better, here, largest)

    def halving(i, best, largest):
        reach = step * dr.exp2(-mi.Float(i))
        for side in (-1, 1):
            t = dr.clip(best + side * reach, near, far)
            here = value(t)
            better = here > largest
            best, largest = dr.select(better, t, best), dr.select(better, here, largest)
        return i + 1, best, largest

    with dr.suspend_grad():
        ends = value(near), value(far)
        state = mi.UInt32(0), dr.select(ends[0] > ends[1], near, far), dr.maximum(*ends)
        _, best, largest = dr.while_loop(state, lambda i, *_: active & (i < steps), part)
        state = mi.UInt32(1), best, largest
        return dr.while_loop(state, lambda i, *_: active & (i <= HALVINGS), halving)[1]
