"""Checks by random samples that a field is a distance, or that ray steps along it are safe."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from brdfkit.core.array_types import ArrayLike, FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.distance_fields.boxes import Box, format_point, join_boxes
from brdfkit.distance_fields.functions import evaluate

ROUNDING_ERROR = 1e-9  # the rounding error of the difference of two values of a field
BALL_SHARE = 0.999  # the longest step of a walk, as a share of the radius without surfaces


def check(
    distance: Callable[[Any], Any],
    low: ArrayLike,
    high: ArrayLike,
    lipschitz: float | None = None,
    samples: int = 100_000,
    seed: int = 0,
) -> None:
    """Check by pairs of random points that a distance is finite, and no steeper than its bound.

    The two points of a pair are between 10⁻⁴ and 1 diagonal of the box apart. A check that finds
    nothing is no proof.

    Parameters
    ----------
    distance : callable
        A node, or a function f(p) of points.
    low, high : three numbers
        The corners of the box that is checked.
    lipschitz : float, optional
        The upper bound on the slope of the field; by default the node's own, else 1.
    samples : integer, default 100_000
        The number of pairs.
    seed : integer, default 0
        Seed of the random numbers.

    Raises
    ------
    BrdfkitError
        If the field is not finite, or too steep, somewhere; the error says where.

    Examples
    --------
    >>> check(lambda p: 3 * p.x, (0, 0, 0), (1, 1, 1))
    brdfkit.core.errors.BrdfkitError: the field changes by 3 per unit near (0.6, 0.2, 0.04), ...
    """
    rng, low, high = np.random.default_rng(seed), np.asarray(low, float), np.asarray(high, float)
    if lipschitz is None:
        lipschitz = getattr(distance, "lipschitz", 1.0)
    distance = getattr(distance, "distance", distance)
    a = rng.uniform(low, high, (samples, 3))
    step = rng.normal(size=(samples, 3))
    step *= 10.0 ** rng.uniform(-4, 0, (samples, 1)) / np.linalg.norm(step, axis=1, keepdims=True)
    b = np.clip(a + step * np.linalg.norm(high - low), low, high)
    f, g = evaluate(distance, a), evaluate(distance, b)
    _require_finite(f, a)
    apart = np.linalg.norm(a - b, axis=1)
    slope = (np.abs(f - g) - ROUNDING_ERROR) / np.maximum(apart, 1e-30)
    worst = int(np.nanargmax(slope))
    if slope[worst] > lipschitz:
        raise BrdfkitError(
            f"the field changes by {slope[worst]:.3g} per unit near {format_point(a[worst])}, "
            f"more than its bound {lipschitz:g}, so that rays may miss the surface; divide the "
            "field by its slope, or state a larger lipschitz."
        )


def check_steps(node: Any, walks: int = 500, steps: int = 8, seed: int = 0) -> None:
    """Check by random walks that rays can step along a field without crossing its surface.

    A ray may step as far as the field's value divided by its bound `lipschitz`, as the ball of this
    radius should contain no surface. A step of a walk leads to a random point of that ball, where
    the field must have the same sign. So a walk soon comes near the surface.

    `check` demands more: an estimate whose values jump, such as the Mandelbulb's, may still have
    safe steps. A check that finds nothing is no proof.

    Parameters
    ----------
    node : distance field
        The field.
    walks : integer, default 500
        The number of walks.
    steps : integer, default 8
        The number of steps in each walk.
    seed : integer, default 0
        Seed of the random numbers.

    Raises
    ------
    BrdfkitError
        If the field is not finite, or a step crosses the surface; the error says where.

    Examples
    --------
    >>> check_steps(sphere(1) | box(2).translate((1, 0, 0)))
    """
    rng = np.random.default_rng(seed)
    low, high = join_boxes(_list_finite_boxes(node) or [(-np.ones(3), np.ones(3))])
    spread = (high - low) * 10 ** rng.uniform(-1, 1, (walks, 1))
    a = (low + high) / 2 + spread * rng.normal(size=(walks, 3))
    f = node(a)
    for _ in range(steps):
        _require_finite(f, a)
        n = rng.normal(size=(walks, 5))
        # Three of the five components of a random unit vector are a uniform point of the unit ball
        inside = n[:, :3] / np.linalg.norm(n, axis=1, keepdims=True)
        b = a + BALL_SHARE * inside * (np.abs(f) / node.lipschitz)[:, None]
        g = node(b)
        for i in np.flatnonzero(f * g < 0)[:1]:
            raise BrdfkitError(
                f"the field is {f[i]:.3g} at {format_point(a[i])}, but its surface is less than "
                f"{np.linalg.norm(b[i] - a[i]):.3g} away: it is steeper than its bound "
                f"{node.lipschitz:g}; divide it by its slope, or state a larger lipschitz."
            )
        a, f = b, g


def _list_finite_boxes(node: Any) -> list[Box]:
    """Return the bounding boxes of those parts of a node that are bounded."""
    if np.isfinite(node.bounds()).all():
        return [node.bounds()]
    return [box for child in node.children for box in _list_finite_boxes(child)]


def _require_finite(f: FloatArray, points: FloatArray) -> None:
    """Raise `BrdfkitError` if a value f (n,) at the points (n, 3) is not finite."""
    bad = ~np.isfinite(f)
    if bad.any():
        place = format_point(points[bad][0])
        raise BrdfkitError(f"the field is {f[bad][0]} at {place}; make it finite everywhere.")
