"""Where rays first meet a node: sphere tracing by its own bound L, within its own box."""

from typing import Any

import drjit as dr
import numpy as np

from brdfkit.distance_fields.node import Node
from brdfkit.distance_fields.tracing.hits import Hit
from brdfkit.distance_fields.tracing.sphere_tracing import sphere_trace


def intersect(
    node: Node,
    o: Any,
    d: Any,
    t_max: Any,
    *,
    precision: Any = 1e-4,
    steps: Any = 512,
    active: Any = True,
) -> Hit:
    """Where rays first meet a field: as `sphere_trace`, along what of them lies in its box.

    Parameters
    ----------
    node : distance field
        Has the surface.
    o, d : anything with x, y, z
        Where the rays begin, and their unit directions: arrays of Dr.Jit's, or numbers.
    t_max : number or array
        Where the rays end, along them.
    precision : number > 0, default 1e-4
        How close f / L has to be to 0.
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
    >>> intersect(sphere(1), mi.ScalarPoint3f(0, 0, 3), mi.ScalarVector3f(0, 0, -1), 9)
    Hit(t=2.0, found=True, distance=0.0, steps=1)
    """
    near, far = span(o, d, *node.bounds())
    return sphere_trace(
        node.distance,
        o,
        d,
        dr.minimum(far, t_max),
        lipschitz=node.lipschitz,
        precision=precision,
        t_min=near,
        steps=steps,
        active=active & (near < far),
    )


def span(o, d, low, high):
    """From where to where, in front of o, rays lie in a box; the second is less if they miss it."""
    near, far = o.x * 0.0, o.x * 0.0 + np.inf
    for a, v, least, most in zip((o.x, o.y, o.z), (d.x, d.y, d.z), low, high, strict=True):
        if np.isfinite(least) and np.isfinite(most):
            inverse = dr.rcp(dr.select(v == 0, 1e-30, v))
            one, two = (float(least) - a) * inverse, (float(most) - a) * inverse
            near = dr.maximum(near, dr.minimum(one, two))
            far = dr.minimum(far, dr.maximum(one, two))
    return near, far
