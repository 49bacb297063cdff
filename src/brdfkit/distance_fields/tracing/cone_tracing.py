"""Cone tracing: where a cone, not only its axis, first meets a surface.

The distance less the cone's radius, over its own bound 1 + |tan α|, is a distance again, that
sphere tracing takes [Bálint et al. 2019, chapter 2]:

    F(t) = (f(o + t d) - ρ(t)) / (1 + |tan α|),   ρ(t) = R₀ + t tan α
"""

from collections.abc import Callable
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.distance_fields.tracing.hits import Hit, start


def cone_trace(
    distance: Callable[[Any], Any],
    o: Any,
    d: Any,
    t_max: Any,
    *,
    radius: Any = 0.0,
    tangent: Any = 0.0,
    slack: Any = 0.0,
    lipschitz: Any = 1.0,
    precision: Any = 1e-4,
    t_min: Any = 0.0,
    steps: Any = 512,
    active: Any = True,
) -> Hit:
    """Where cones about rays first touch a surface, be it as thin as a line.

    A cone stops where f / L ≤ (1 + slack) ρ + precision. As its steps end at ρ, nothing that
    reaches into it is passed; what lies between ρ and (1 + slack) ρ may be found or not. `distance`
    of the `Hit` is the radius of an empty ball there.

    Parameters
    ----------
    distance : callable
        f(p) of points, no steeper than `lipschitz`; as a node's `distance`.
    o, d : anything with x, y, z
        Where the rays begin, and their unit directions: arrays of Dr.Jit's, or numbers.
    t_max : number or array
        Where the rays end, along them.
    radius : number or array ≥ 0, default 0
        R₀ of the cones, at t = 0.
    tangent : number or array, default 0
        tan α, by which they widen; negative where they narrow.
    slack : number ≥ 0, default 0
        The share of ρ at which a cone may stop early; with more it takes fewer steps.
    lipschitz : number, default 1
        L of f.
    precision : number > 0, default 1e-4
        How close f / L has to be to ρ.
    t_min : number or array, default 0
        Where the rays start, along them.
    steps : integer, default 512
        The steps after which a cone is given up.
    active : bool or array, default True
        Which rays are traced.

    Returns
    -------
    Hit
        Where they stop, and whether a surface is there; without derivatives, see `reattach`.

    Examples
    --------
    >>> line = capsule((-1, 0, 0), (1, 0, 0), 0)
    >>> cone_trace(line.distance, o, d, 9, tangent=pixel_tangent(40, 512), slack=0.25)
    Hit(t=..., found=True, ...)
    """
    with dr.suspend_grad():
        t, count = start(o, t_min)

        def enough(t):
            return (1.0 + slack) * (radius + t * tangent) + precision

        def goes_on(t, f, i):
            return active & (f > enough(t)) & (t < t_max) & (i < steps)

        def step(t, f, i):
            t = t + (f - (radius + t * tangent)) / (1.0 + abs(tangent))
            return t, distance(o + d * t) / lipschitz, i + 1

        first = distance(o + d * t) / lipschitz
        t, f, count = dr.while_loop((t, first, count + 1), goes_on, step)
        return Hit(t, active & (f <= enough(t)) & (t < t_max), f, count)


def pixel_tangent(fov: float, pixels: int) -> float:
    """tan α of the cone that covers a pixel of a perspective picture, up to its corners.

    Such cones of all pixels leave no gap, so that no object between them is missed.

    Parameters
    ----------
    fov : float [degrees]
        The angle of view across the picture.
    pixels : integer
        How many pixels there are across it.

    Returns
    -------
    float
        tan α.

    Examples
    --------
    >>> pixel_tangent(90, 1000)
    0.0014142135623730948
    """
    return float(np.sqrt(2) * np.tan(np.radians(fov) / 2) / pixels)
