"""Piecewise linear functions over points that rise: where a number lies among them."""

import numpy as np

from brdfkit.core.errors import BrdfkitError


def require_order(points, what):
    """`points` (n,) as floats; `BrdfkitError` unless there are two or more and they rise."""
    try:
        points = np.array(points, float)
    except (TypeError, ValueError):
        points = np.empty(0)
    if points.ndim != 1 or len(points) < 2 or not np.isfinite(points).all():
        raise BrdfkitError(f"{what} should be two or more numbers, one for each point.")
    falls = np.flatnonzero(np.diff(points) < 0)
    if falls.size:
        i = int(falls[0])
        raise BrdfkitError(
            f"{what} are out of order: point {i + 2} ({points[i + 1]:g}) lies before point {i + 1} "
            f"({points[i]:g}); sort the points."
        )
    if points[0] == points[-1]:
        raise BrdfkitError(f"{what} are all {points[0]:g}; the last should be above the first.")
    return points


def places(x, points):
    """The points below and above `x` (...), and the share (..., 1) of the upper one.

    Of points at one place the last counts from there on; beyond the ends x is at the end.

    >>> places(np.array([0.5, 9.0]), np.array([0.0, 2.0]))
    (array([0, 0]), array([1, 1]), array([[0.25],
           [1.  ]]))
    """
    low = np.clip(np.searchsorted(points, x, side="right") - 1, 0, len(points) - 2)
    width = points[low + 1] - points[low]
    ahead = np.where(width > 0, (x - points[low]) / np.where(width > 0, width, 1), 1)
    return low, low + 1, np.clip(ahead, 0, 1)[..., None]
