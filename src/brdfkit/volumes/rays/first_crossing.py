"""Where along a ray a function first rises above 0: a level set, met from outside."""

import drjit as dr

from brdfkit.core.jit.loops import record_loops

HALVINGS = 8  # of a step, before a last linear one


@record_loops
def first_above(f, near, far, steps, active):
    """The first of `steps` + 1 even places from `near` to `far` where `f(t)` is above 0.

    Its number, its distance and f there, which is not above 0 where there is no such place.
    """
    import mitsuba as mi

    step = (far - near) / steps

    def part(i, t, above):
        t = near + mi.Float(i + 1) * step
        return i + 1, t, f(t)

    with dr.suspend_grad():
        return dr.while_loop(
            (mi.UInt32(0), mi.Float(near), mi.Float(f(near))),
            lambda i, t, above: active & (i < steps) & (above <= 0),
            part,
        )


@record_loops
def first_crossing(f, near, far, steps, active):
    """The distance from `near` to `far` where `f(t)` first rises above 0, and whether it does.

    The place of `first_above` lies too deep by half a part in the mean; here the part before it is
    halved, so that less than 1e-6 of the ray is left. What is thinner than a part may be missed.
    Where f is above 0 at `near`, that is the distance. Nothing has derivatives, see `reattach`.
    """
    import mitsuba as mi

    i, t, above = first_above(f, near, far, steps, active)
    found = active & (above > 0)
    refined = found & (i > 0)

    def halve(n, outside, inside, below, above):
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


def reattach(f, t, slope):
    """`t` of a crossing with its derivatives by all that `f` depends on: dt = -df / slope.

    slope : df/dt there, without derivatives. Where it is not above 0, the ray grazes, and t has
        none.
    """
    here = f(dr.detach(t))
    change = (here - dr.detach(here)) / dr.select(slope > 0, slope, 1)
    return t - dr.select(slope > 0, change, 0)
