"""Normals: the direction in which f grows.

By four values of f at the corners of a tetrahedron. Automatic differentiation would be exact and
takes half of the time, but Dr.Jit has no derivatives of derivatives, and in scalar variants none at
all: these normals have derivatives by every parameter of f, and are the same everywhere.
"""

from collections.abc import Callable
from typing import Any

import drjit as dr

CORNERS = ((1, -1, -1), (-1, -1, 1), (-1, 1, -1), (1, 1, 1))


def normal(distance: Callable[[Any], Any], p: Any, step: float = 1e-3) -> Any:
    """The unit normal of a distance.

    Parameters
    ----------
    distance : callable
        f(p) of points; as a node's `distance`.
    p : anything with x, y, z
        Points on the surface or near it.
    step : float > 0, default 1e-3
        Half of the edge of the cube that has the tetrahedron; less than all details.

    Returns
    -------
    points
        Of the type of `p`.

    Examples
    --------
    >>> normal(sphere(1).distance, mi.ScalarPoint3f(0, 0, 1))
    [0, 0, 1]
    """
    x: Any = 0.0
    y, z = x, x
    for i, j, k in CORNERS:
        f = distance(p + type(p)(i * step, j * step, k * step))
        x, y, z = x + i * f, y + j * f, z + k * f
    size = dr.sqrt(dr.maximum(x * x + y * y + z * z, 1e-30))
    return type(p)(x / size, y / size, z / size)
