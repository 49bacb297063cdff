"""Matplotlib's colour maps as control points."""

import numpy as np

from brdfkit.core.arguments import to_pair
from brdfkit.core.colours import from_srgb
from brdfkit.core.errors import BrdfkitError, no_such


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


def function(cls, colormap, values, opacity, extinction, colour):
    """The transfer function, of the class `cls`, with the colours of a colour map."""
    low, high = to_pair("values", values)
    name, shares, rgba = points(colormap, opacity)
    return cls(low + (high - low) * shares, rgba, extinction, colour, name=name)


def points(colormap, opacity):
    """The name of a colour map, its places (n,), 0 to 1, and RGBA (n, 4) in linear sRGB.

    `opacity` (k, 2): points (place, A).
    """
    import matplotlib

    if isinstance(colormap, str):
        try:
            colormap = matplotlib.colormaps[colormap]
        except KeyError:
            raise no_such("colour map", colormap, sorted(matplotlib.colormaps)) from None
    ramp = np.asarray(opacity, float)
    if ramp.ndim != 2 or ramp.shape[1] != 2:
        raise BrdfkitError("opacity should be points (share of the range, A), (k, 2).")
    at = require_order(ramp[:, 0], "the shares of opacity")
    before_steps = np.nextafter(at[1:][np.diff(at) == 0], -np.inf)
    corners = np.clip(np.concatenate([at, before_steps]), 0, 1)
    shares = np.union1d(np.linspace(0, 1, colormap.N), corners)  # of the map and the ramp
    low, high, t = places(shares, at)
    alpha = (1 - t[:, 0]) * ramp[low, 1] + t[:, 0] * ramp[high, 1]
    rgb = from_srgb(colormap(shares)[:, :3])
    return colormap.name, shares, np.column_stack([rgb, alpha])
