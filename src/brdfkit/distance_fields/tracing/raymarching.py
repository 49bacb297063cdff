"""Ray marching: fixed steps until f changes its sign, then bisection; needs no bound of its slope.

[Bálint et al. 2019, algorithm 1]
"""

from collections.abc import Callable
from typing import Any

import drjit as dr

from brdfkit.distance_fields.tracing.hits import Hit, start

BISECTIONS = 24  # a step / 2²⁴ is what single precision tells apart


def raymarch(
    distance: Callable[[Any], Any], o: Any, d: Any, t_max: Any, step: Any, active: Any = True
) -> Hit:
    """Where f first changes its sign along rays, by steps of one length.

    Parameters
    ----------
    distance : callable
        f(p) of points; as a node's `distance`.
    o, d : anything with x, y, z
        Where the rays begin, and their unit directions: arrays of Dr.Jit's, or numbers.
    t_max : number or array
        Where the rays end, along them.
    step : number > 0
        The length; what a ray crosses within a shorter way may be missed.
    active : bool or array, default True
        Which rays are traced.

    Returns
    -------
    Hit
        Where they stop, and whether a surface is there; without derivatives, see `reattach`.

    Examples
    --------
    >>> raymarch(torus(1, 0.2).distance, o, d, 9, 0.01)
    Hit(t=..., found=True, ...)
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
