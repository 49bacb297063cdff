"""Sphere tracing and cone tracing: where a ray, or a cone around it, first touches a surface.

The field f divided by its bound L is at most the distance. So a step of this length along a ray
crosses no surface [Hart 1996]; [Bálint et al. 2019, algorithm 2]. Along a cone, f / L less the
cone's radius ρ changes by at most 1 + |tan α| per length, with the angle α between axis and side.
Divided by that, it is a safe step again [Bálint et al. 2019, chapter 2]:

    F(t) = (f(o + t d) / L - ρ(t)) / (1 + |tan α|),   ρ(t) = R₀ + t tan α

A ray is a cone of radius 0.
"""

from collections.abc import Callable
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.array_types import FloatArray, JitFloat, JitInt, JitMask, JitVector
from brdfkit.distance_fields.node import Node
from brdfkit.distance_fields.tracing.hits import Hit, make_march_start


def cone_trace(
    distance: Callable[[Any], Any],
    o: JitVector,
    d: JitVector,
    t_max: JitFloat,
    *,
    radius: JitFloat = 0.0,
    tangent: JitFloat = 0.0,
    slack: JitFloat = 0.0,
    lipschitz: JitFloat = 1.0,
    precision: JitFloat = 1e-4,
    t_min: JitFloat = 0.0,
    steps: JitInt = 512,
    active: JitMask = True,
) -> Hit:
    """Find where rays, or cones about them, first touch a surface, be it as thin as a line.

    Without `radius` and `tangent` it traces rays. A cone of the radius ρ stops where
    f / L ≤ (1 + slack) ρ + precision. No step goes beyond the place where f / L could be ρ, so that
    nothing in the cone is missed; a surface between ρ and (1 + slack) ρ may be found or not.

    Parameters
    ----------
    distance : callable
        f(p) of points, no steeper than `lipschitz`; such as a node's `distance`.
    o, d : anything with x, y, z
        Where the rays begin, and their unit directions: Dr.Jit arrays, or numbers.
    t_max : number or array
        The distance along the rays at which they end.
    radius : number or array ≥ 0, default 0
        R₀, the radius of the cones at t = 0.
    tangent : number or array, default 0
        tan α, the growth of the radius per length; negative for narrowing cones.
    slack : number ≥ 0, default 0
        The share of ρ at which a cone may stop early; with more it takes fewer steps.
    lipschitz : number, default 1
        The bound L on the slope of f.
    precision : number > 0, default 1e-4
        The difference of f / L and ρ at which a cone touches the surface.
    t_min : number or array, default 0
        The distance along the rays at which they start.
    steps : integer, default 512
        The number of steps after which a ray ends.
    active : bool or array, default True
        Which rays are traced.

    Returns
    -------
    Hit
        Where the cones stop, and whether a surface is there; without derivatives, see `reattach`.
        Its `distance` is the radius of a ball there that contains no surface.

    Examples
    --------
    >>> line = capsule((-1, 0, 0), (1, 0, 0), 0)
    >>> cone_trace(line.distance, o, d, 9, tangent=pixel_tangent(40, 512), slack=0.25)
    Hit(t=..., found=True, ...)
    """
    with dr.suspend_grad():
        t, count = make_march_start(o, t_min)

        def touch_threshold(t: JitFloat) -> JitFloat:
            return (1.0 + slack) * (radius + t * tangent) + precision

        def take_step(t: JitFloat, f: JitFloat, i: JitInt) -> tuple[JitFloat, JitFloat, JitInt]:
            t = t + (f - (radius + t * tangent)) / (1.0 + abs(tangent))
            return t, distance(o + d * t) / lipschitz, i + 1

        first = distance(o + d * t) / lipschitz
        t, f, count = dr.while_loop(
            (t, first, count + 1),
            lambda t, f, i: active & (f > touch_threshold(t)) & (t < t_max) & (i < steps),
            take_step,
        )
        return Hit(t, active & (f <= touch_threshold(t)) & (t < t_max), f, count)


def intersect(
    node: Node,
    o: JitVector,
    d: JitVector,
    t_max: JitFloat,
    *,
    precision: JitFloat = 1e-4,
    steps: JitInt = 512,
    active: JitMask = True,
) -> Hit:
    """Find where rays first meet a field, by `cone_trace` within the field's bounding box.

    Parameters
    ----------
    node : distance field
        The field, which knows its bound L and its box.
    o, d : anything with x, y, z
        The origins of the rays and their unit directions: Dr.Jit arrays, or numbers.
    t_max : number or array
        The distance along the rays at which they end.
    precision : number > 0, default 1e-4
        The value of f / L at which a ray meets the surface.
    steps : integer, default 512
        The number of steps after which a ray ends.
    active : bool or array, default True
        Whether each ray is traced.

    Returns
    -------
    Hit
        Where the rays stop, and whether a surface is there; without derivatives, see `reattach`.

    Examples
    --------
    >>> intersect(sphere(1), mi.ScalarPoint3f(0, 0, 3), mi.ScalarVector3f(0, 0, -1), 9)
    Hit(t=2.0, found=True, distance=0.0, steps=1)
    """
    near, far = clip_to_box(o, d, *node.bounds())
    t_max, active = dr.minimum(far, t_max), active & (near < far)
    settings = {"precision": precision, "t_min": near, "steps": steps, "active": active}
    return cone_trace(node.distance, o, d, t_max, lipschitz=node.lipschitz, **settings)


def clip_to_box(
    o: JitVector, d: JitVector, low: FloatArray, high: FloatArray
) -> tuple[JitFloat, JitFloat]:
    """Return the distances at which rays enter and leave a box; far < near if a ray misses it.

    Only the part of a ray in front of its origin `o` counts.
    """
    near, far = o.x * 0.0, o.x * 0.0 + np.inf
    for a, v, least, most in zip((o.x, o.y, o.z), (d.x, d.y, d.z), low, high, strict=True):
        if np.isfinite(least) and np.isfinite(most):
            inverse = dr.rcp(dr.select(v == 0, 1e-30, v))
            one, two = (float(least) - a) * inverse, (float(most) - a) * inverse
            near = dr.maximum(near, dr.minimum(one, two))
            far = dr.minimum(far, dr.maximum(one, two))
    return near, far


def pixel_tangent(fov: float, pixels: int) -> float:
    """Return tan α of the cone that covers a pixel of a perspective picture, up to its corners.

    The cones of all pixels leave no gap, so that no object between them is missed.

    Parameters
    ----------
    fov : float [degrees]
        The angle of view across the picture.
    pixels : integer
        The number of pixels across the picture.

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
