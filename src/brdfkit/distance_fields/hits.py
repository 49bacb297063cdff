"""What a ray meets: the result of every way to trace it."""

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


def reattach(distance, o, d, t):
    """`t` with its derivatives, by all parameters of f and of the ray, where f(o + t d) = 0.

    The march has none. By the implicit function theorem dt = -df / (∇f·d), with f's slope along the
    ray taken by a central difference. Rays that graze the surface get 0.
    """
    t = dr.detach(t)
    h = dr.maximum(1e-3 * dr.abs(t), 1e-3)
    with dr.suspend_grad():
        slope = (distance(o + d * (t + h)) - distance(o + d * (t - h))) / (2 * h)
    f = distance(o + d * t)
    grazing = dr.abs(slope) < 1e-4
    change = (f - dr.detach(f)) / dr.select(grazing, 1.0, slope)
    return t - dr.select(grazing, 0.0, change)
