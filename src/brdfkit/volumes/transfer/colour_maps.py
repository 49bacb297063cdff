"""Transfer functions from Matplotlib's colour maps, and helpers for control points."""

from __future__ import annotations

from typing import Any

import numpy as np

from brdfkit.core.arguments import to_number_pair
from brdfkit.core.array_types import ArrayLike, FloatArray, IntArray
from brdfkit.core.colours import from_srgb
from brdfkit.core.errors import BrdfkitError, no_such_error


def require_rising(given: ArrayLike, what: str) -> FloatArray:
    """Return numbers as floats (n,); raise `BrdfkitError` unless they rise like control points.

    There must be at least two numbers, and neighbours may be equal. The error calls them `what`.
    """
    try:
        points = np.array(given, float)
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


def find_bracketing_points(
    x: FloatArray, points: FloatArray
) -> tuple[IntArray, IntArray, FloatArray]:
    """Find the control points between which to interpolate at `x`: their indices, and a weight.

    `points` (n,) rise. Returns the indices of the point below and of the point above each x, both
    of the shape of `x`, and the weight (..., 1) of the upper one. Of several points with one value,
    the last one counts at the value itself. Beyond the ends, the nearest end has the weight 1.

    >>> find_bracketing_points(np.array([0.5, 9.0]), np.array([0.0, 2.0]))
    (array([0, 0]), array([1, 1]), array([[0.25],
           [1.  ]]))
    """
    low = np.clip(np.searchsorted(points, x, side="right") - 1, 0, len(points) - 2)
    width = points[low + 1] - points[low]
    ahead = np.where(width > 0, (x - points[low]) / np.where(width > 0, width, 1), 1)
    return low, low + 1, np.clip(ahead, 0, 1)[..., None]


def convert_colormap(
    cls: Any,
    colormap: Any,
    values: tuple[float, float],
    opacity: ArrayLike,
    extinction: float,
    colour: str,
) -> Any:
    """Make a transfer function, of the class `cls`, with the colours of a Matplotlib colour map.

    See `Conversions.from_colormap` for the arguments.
    """
    low, high = to_number_pair("values", values)
    name, shares, rgba = _read_colormap(colormap, opacity)
    return cls(low + (high - low) * shares, rgba, extinction, colour, name=name)


def _read_colormap(colormap: Any, opacity: ArrayLike) -> tuple[str, FloatArray, FloatArray]:
    """Return the name of a colour map, control points (n,) from 0 to 1, and their RGBA (n, 4).

    RGB is linear sRGB; A is interpolated between the rows (point, A) of `opacity`.
    """
    import matplotlib

    if isinstance(colormap, str):
        try:
            colormap = matplotlib.colormaps[colormap]
        except KeyError:
            raise no_such_error("colour map", colormap, sorted(matplotlib.colormaps)) from None
    ramp = np.asarray(opacity, float)
    if ramp.ndim != 2 or ramp.shape[1] != 2:
        raise BrdfkitError("opacity should be points (share of the range, A), (k, 2).")
    at = require_rising(ramp[:, 0], "the shares of opacity")
    before_steps = np.nextafter(at[1:][np.diff(at) == 0], -np.inf)
    corners = np.clip(np.concatenate([at, before_steps]), 0, 1)
    shares = np.union1d(np.linspace(0, 1, colormap.N), corners)
    low, high, t = find_bracketing_points(shares, at)
    alpha = (1 - t[:, 0]) * ramp[low, 1] + t[:, 0] * ramp[high, 1]
    rgb = from_srgb(colormap(shares)[:, :3])
    return str(colormap.name), shares, np.column_stack([rgb, alpha])
