"""`Hit`, the result of every way to trace rays, with derivatives and normals of hits."""

from collections.abc import Callable
from typing import Any, NamedTuple

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitInt, JitVector


class Hit(NamedTuple):
    """The places where rays meet a surface: arrays over all rays, or numbers.

    Attributes
    ----------
    t : distance along each ray at which it stopped
    found : bool, whether a surface is there
    distance : distance to the surface at that point: a ball of this radius contains no surface
    steps : number of evaluations of the distance
    """

    t: Any
    found: Any
    distance: Any
    steps: Any


def make_march_start(o: JitVector, t: JitFloat) -> tuple[JitFloat, JitInt]:
    """Return `t` and a count of 0, as arrays over the rays that begin at `o`."""
    return o.x * 0.0 + t, dr.uint32_array_t(type(o.x))(0)


def reattach(distance: Callable[[Any], Any], o: JitVector, d: JitVector, t: JitFloat) -> JitFloat:
    """Return the `t` of hits with derivatives, for all parameters of the field and of the rays.

    By the implicit function theorem dt = -df / (∇f·d), with the field f; a central difference gives
    its slope along the ray. Rays that graze the surface get 0.

    Parameters
    ----------
    distance : callable
        f(p) of points, whose parameters carry derivatives; such as a node's `distance`.
    o, d : anything with x, y, z
        The origins of the rays and their unit directions.
    t : array
        The distances at which rays meet the surface; for other rays, the derivatives mean nothing.

    Returns
    -------
    array
        The same numbers, with derivatives.

    Examples
    --------
    >>> ball = sphere(1).with_parameters({"sphere.radius": radius})
    >>> t = reattach(ball.distance, o, d, intersect(ball, o, d, 9).t)
    >>> dr.backward(dr.sum(t))
    """
    t = dr.detach(t)
    h = dr.maximum(1e-3 * dr.abs(t), 1e-3)
    with dr.suspend_grad():
        slope = (distance(o + d * (t + h)) - distance(o + d * (t - h))) / (2 * h)
    f = distance(o + d * t)
    grazing = dr.abs(slope) < 1e-4
    change = (f - dr.detach(f)) / dr.select(grazing, 1.0, slope)
    return t - dr.select(grazing, 0.0, change)


TETRAHEDRON = ((1, -1, -1), (-1, -1, 1), (-1, 1, -1), (1, 1, 1))


def normal(distance: Callable[[Any], Any], p: JitVector, step: float = 1e-3) -> JitVector:
    """Return the unit normal of a distance function f, the direction in which f grows.

    It is computed from four values of f. Automatic differentiation would be exact and take half the
    time. But Dr.Jit has no second derivatives, and scalar variants have none at all; these normals
    have derivatives with respect to every parameter of f, and are the same in all variants.

    Parameters
    ----------
    distance : callable
        f(p) of points; such as a node's `distance`.
    p : anything with x, y, z
        Points on the surface or near it.
    step : float > 0, default 1e-3
        Half the edge of a cube around p, at four corners of which f is evaluated; less than the
        size of all details.

    Returns
    -------
    points
        The normals, of the same type as `p`.

    Examples
    --------
    >>> normal(sphere(1).distance, mi.ScalarPoint3f(0, 0, 1))
    [0, 0, 1]
    """
    x: Any = 0.0
    y, z = x, x
    for i, j, k in TETRAHEDRON:
        f = distance(p + type(p)(i * step, j * step, k * step))
        x, y, z = x + i * f, y + j * f, z + k * f
    size = dr.sqrt(dr.maximum(x * x + y * y + z * z, 1e-30))
    return type(p)(x / size, y / size, z / size)
