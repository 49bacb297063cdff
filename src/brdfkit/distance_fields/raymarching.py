"""Ray marching: fixed steps until f changes its sign, then bisection; needs no bound of its slope.

[Bálint et al. 2019, algorithm 1]
"""

import drjit as dr

from brdfkit.distance_fields.hits import Hit, start

BISECTIONS = 24  # a step / 2²⁴ is what single precision tells apart


def raymarch(distance, o, d, t_max, step, active=True):
    """Where f first changes its sign along rays, by steps of one length.

    What a ray crosses within a shorter way than `step` may be missed. The march carries no
    derivatives: see `hits.reattach`.
    """
    with dr.suspend_grad():
        t, count = start(o, step)

        def goes_on(t, before, after, i):
            return active & (before * after > 0) & (t < t_max)

        def advance(t, before, after, i):
            t = t + step
            return t, after, distance(o + d * t), i + 1

        first, second = distance(o + d * (t - step)), distance(o + d * t)
        t, before, after, count = dr.while_loop((t, first, second, count + 2), goes_on, advance)
        found = active & (before * after <= 0)

        def halve(low, high, i):
            middle = 0.5 * (low + high)
            same = before * distance(o + d * middle) > 0
            return dr.select(same, middle, low), dr.select(same, high, middle), i + 1

        _, t, _ = dr.while_loop(
            (t - step, t, count * 0), lambda low, high, i: found & (i < BISECTIONS), halve
        )
        return Hit(t, found, distance(o + d * t), count + BISECTIONS)
