"""Sphere tracing: as f is no more than the distance, a step by f meets no surface.

A ray is a cone of radius 0.

[Hart 1996]; [Bálint et al. 2019, algorithm 2]
"""

from collections.abc import Callable
from typing import Any

from brdfkit.distance_fields.tracing.cone_tracing import cone_trace
from brdfkit.distance_fields.tracing.hits import Hit


def sphere_trace(
    distance: Callable[[Any], Any],
    o: Any,
    d: Any,
    t_max: Any,
    *,
    lipschitz: Any = 1.0,
    precision: Any = 1e-4,
    t_min: Any = 0.0,
    steps: Any = 512,
    active: Any = True,
) -> Hit:
    """Where rays first come close to a surface; one that starts inside is found where it starts.

    Parameters
    ----------
    distance : callable
        f(p) of points, no steeper than `lipschitz`; as a node's `distance`.
    o, d : anything with x, y, z
        Where the rays begin, and their unit directions: arrays of Dr.Jit's, or numbers.
    t_max : number or array
        Where the rays end, along them.
    lipschitz : number, default 1
        L of f; a step is f / L.
    precision : number > 0, default 1e-4
        How close f / L has to be to 0.
    t_min : number or array, default 0
        Where the rays start, along them.
    steps : integer, default 512
        The steps after which a ray is given up.
    active : bool or array, default True
        Which rays are traced.

    Returns
    -------
    Hit
        Where they stop, and whether a surface is there; without derivatives, see `reattach`.

    Examples
    --------
    >>> sphere_trace(sphere(1).distance, mi.ScalarPoint3f(0, 0, 3), mi.ScalarVector3f(0, 0, -1), 9)
    Hit(t=2.0, found=True, distance=0.0, steps=2)
    """
    return cone_trace(
        distance,
        o,
        d,
        t_max,
        lipschitz=lipschitz,
        precision=precision,
        t_min=t_min,
        steps=steps,
        active=active,
    )
