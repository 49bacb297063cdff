"""What a ray meets: the result of every way to trace it."""

from collections.abc import Callable
from typing import Any, NamedTuple

import drjit as dr


class Hit(NamedTuple):
    """Where a ray meets a surface: arrays over all rays, or numbers.

    Attributes
    ----------
    t : distance along the ray, where it stopped
    found : bool, whether a surface is there
    distance : f at that point: no surface is nearer, so that a ball of that radius is empty
    steps : how often f was evaluated on the way
    """

    t: Any
    found: Any
    distance: Any
    steps: Any


def start(o, t):
    """`t` and a count of 0, as arrays over the rays that begin at `o`."""
    return o.x * 0.0 + t, dr.uint32_array_t(type(o.x))(0)


def reattach(distance: Callable[[Any], Any], o: Any, d: Any, t: Any) -> Any:
    """`t` of hits with its derivatives by all parameters of f and of the rays.

    By the implicit function theorem dt = -df / (∇f·d), with f's slope along the ray taken by a
    central difference. Rays that graze the surface get 0.

    Parameters
    ----------
    distance : callable
        f(p) of points, whose parameters carry derivatives; as a node's `distance`.
    o, d : anything with x, y, z
        Where the rays begin, and their unit directions.
    t : array
        Where they were found to meet the surface; of other rays the derivatives mean nothing.

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
