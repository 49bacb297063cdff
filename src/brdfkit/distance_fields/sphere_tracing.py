"""Sphere tracing: as f is no more than the distance, a step by f meets no surface.

[Hart 1996]; [Bálint et al. 2019, algorithm 2]
"""

import drjit as dr

from brdfkit.distance_fields.hits import Hit, start


def sphere_trace(
    distance, o, d, t_max, *, lipschitz=1.0, precision=1e-4, t_min=0.0, steps=512, active=True
):
    """Where rays first come within `precision` of the surface of `distance`.

    It starts at o + t_min d, `d` a unit vector, and ends at `t_max`, or after so many `steps`.
    Every step is f / `lipschitz`. A ray that starts inside is found there. The march carries no
    derivatives: see `hits.reattach`.
    """
    with dr.suspend_grad():
        t, count = start(o, t_min)

        def goes_on(t, f, i):
            return active & (f > precision) & (t < t_max) & (i < steps)

        def step(t, f, i):
            t = t + f
            return t, distance(o + d * t) / lipschitz, i + 1

        first = distance(o + d * t) / lipschitz
        t, f, count = dr.while_loop((t, first, count + 1), goes_on, step)
        return Hit(t, active & (f <= precision) & (t < t_max), f, count)
