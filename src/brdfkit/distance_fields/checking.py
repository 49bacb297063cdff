"""Checks by samples that a distance is finite, no steeper than its bound L, and its steps safe."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from brdfkit.core.errors import BrdfkitError
from brdfkit.distance_fields.boxes import join
from brdfkit.distance_fields.functions import evaluate

ROUNDING = 1e-9
WITHIN = 0.999  # of the ball that should hold no surface


def check(
    distance: Callable[[Any], Any],
    low: ArrayLike,
    high: ArrayLike,
    lipschitz: float | None = None,
    samples: int = 100_000,
    seed: int = 0,
) -> None:
    """Check by pairs of points that a distance is finite, and no steeper than its bound.

    The points of a pair are apart by the diagonal of the box, down to 10⁻⁴ of it. That nothing is
    found is no proof.

    Parameters
    ----------
    distance : callable
        f(p) of points; or a node.
    low, high : three numbers
        The corners of the box in which it is checked.
    lipschitz : float, optional
        The bound L; by default that of the node, else 1.
    samples : integer, default 100_000
        How many pairs are drawn.
    seed : integer, default 0
        Of the random numbers.

    Raises
    ------
    BrdfkitError
        Where f is not finite, or steeper; it says where.

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
    _refuse_infinite(f, a)
    apart = np.linalg.norm(a - b, axis=1)
    steepness = (np.abs(f - g) - ROUNDING) / np.maximum(apart, 1e-30)
    worst = int(np.nanargmax(steepness))
    if steepness[worst] > lipschitz:
        raise BrdfkitError(
            f"the field changes by {steepness[worst]:.3g} per unit near {_place(a[worst])}, "
            f"more than its bound {lipschitz:g}: no distance does; divide it by the slope."
        )


def check_steps(node: Any, walks: int = 500, steps: int = 8, seed: int = 0) -> None:
    """Check by random walks that no step by f / L passes the surface of a node.

    This is less than `check` asks: an estimate whose values jump, as the Mandelbulb's, may be safe.
    Each walk steps to anywhere in the ball about it that should hold no surface, and so comes near
    the surface soon, wherever it begins. That nothing is found is no proof.

    Parameters
    ----------
    node : distance field
        As a scene has it.
    walks : integer, default 500
        How many walks there are.
    steps : integer, default 8
        Of each walk.
    seed : integer, default 0
        Of the random numbers.

    Raises
    ------
    BrdfkitError
        Where f is not finite, or a step passes the surface; it says where.

    Examples
    --------
    >>> check_steps(sphere(1) | box(2).translate((1, 0, 0)))
    """
    rng = np.random.default_rng(seed)
    low, high = join(_boxes(node) or [(-np.ones(3), np.ones(3))])
    spread = (high - low) * 10 ** rng.uniform(-1, 1, (walks, 1))
    a = (low + high) / 2 + spread * rng.normal(size=(walks, 3))
    f = node(a)
    for _ in range(steps):
        _refuse_infinite(f, a)
        n = rng.normal(size=(walks, 5))
        inside = n[:, :3] / np.linalg.norm(n, axis=1, keepdims=True)  # uniform in the unit ball
        b = a + WITHIN * inside * (np.abs(f) / node.lipschitz)[:, None]
        g = node(b)
        for i in np.flatnonzero(f * g < 0)[:1]:
            raise BrdfkitError(
                f"the field is {f[i]:.3g} at {_place(a[i])}, yet its surface is within "
                f"{np.linalg.norm(b[i] - a[i]):.3g} of that: it is steeper than its bound "
                f"{node.lipschitz:g}; divide it by its slope, or state a larger lipschitz."
            )
        a, f = b, g


def _boxes(node):
    """The boxes of what of a node is not endless."""
    if np.isfinite(node.bounds()).all():
        return [node.bounds()]
    return [box for child in node.children for box in _boxes(child)]


def _refuse_infinite(f, points):
    bad = ~np.isfinite(f)
    if bad.any():
        raise BrdfkitError(
            f"the field is {f[bad][0]} at {_place(points[bad][0])}; a distance is finite."
        )


def _place(p):
    return f"({', '.join(f'{c:.3g}' for c in p)})"
