"""Matplotlib's colour maps as control points."""

import numpy as np

from brdfkit.core.arguments import to_pair
from brdfkit.core.colours import from_srgb
from brdfkit.core.errors import BrdfkitError, no_such
from brdfkit.volumes.transfer.piecewise import places, require_order


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
