"""Ray marching by fixed steps until f changes its sign, then bisection; it needs no bound L.

[Bálint et al. 2019, algorithm 1]
"""

from collections.abc import Callable
from typing import Any

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitInt, JitMask, JitVector
from brdfkit.distance_fields.tracing.hits import Hit, make_march_start

BISECTIONS = 24  # halvings of the last step, after which single precision resolves nothing more


def raymarch(
    distance: Callable[[Any], Any],
    o: JitVector,
    d: JitVector,
    t_max: JitFloat,
    step: JitFloat,
    active: JitMask = True,
) -> Hit:
    """Find where a distance first changes its sign along rays, by steps of equal length.

    Parameters
    ----------
    distance : callable
        A function f(p) of points, such as a node's `distance`.
    o, d : anything with x, y, z
        The origins of the rays and their unit directions: Dr.Jit arrays, or numbers.
    t_max : number or array
        The distance along the rays at which they end.
    step : number > 0
        The length of a step; an object that a ray crosses in less may be missed.
    active : bool or array, default True
        Whether each ray is traced.

    Returns
    -------
    Hit
        Where the rays stop, and whether a surface is there; without derivatives, see `reattach`.

    Examples
    --------
    >>> raymarch(torus(1, 0.2).distance, o, d, 9, 0.01)
    Hit(t=..., found=True, ...)
    """
    with dr.suspend_grad():
        t, count = make_march_start(o, step)

        def take_step(t: JitFloat, before: JitFloat, after: JitFloat, i: JitInt) -> tuple[Any, ...]:
            t = t + step
            return t, after, distance(o + d * t), i + 1

        first, second = distance(o + d * (t - step)), distance(o + d * t)
        t, before, after, count = dr.while_loop(
            (t, first, second, count + 2),
            lambda t, before, after, i: active & (before * after > 0) & (t < t_max),
            take_step,
        )
        found = active & (before * after <= 0)

        def bisect(low: JitFloat, high: JitFloat, i: JitInt) -> tuple[JitFloat, JitFloat, JitInt]:
            middle = 0.5 * (low + high)
            same = before * distance(o + d * middle) > 0
            return dr.select(same, middle, low), dr.select(same, high, middle), i + 1

        _, t, _ = dr.while_loop(
            (t - step, t, count * 0), lambda low, high, i: found & (i < BISECTIONS), bisect
        )
        return Hit(t, found, distance(o + d * t), count + BISECTIONS)
