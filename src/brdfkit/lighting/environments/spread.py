"""How the light of a map is spread: the directions and solid angles of pixels, shares of the light.

Of maps in the convention of Mitsuba, by latitude and longitude with rows at the poles.
"""

import numpy as np

from brdfkit.core.geometry import latitude_rows
from brdfkit.lighting.environments.conventions import convention


def directions(height, width, dx=0.0, dy=0.0):
    """The directions (height, width, 3) of the pixels, in a world with y up.

    `dx`, `dy`: so much from the middles of the pixels [pixels].
    """
    mitsuba = convention("mitsuba")
    x, y = np.arange(width)[None, :] + dx, np.arange(height)[:, None] + dy
    return mitsuba.layout.directions(x, y, height, width) @ mitsuba.frame.T


def solid_angles(height, width):
    """The solid angles [sr] (height, width) of the pixels."""
    rows = latitude_rows.solid_angles(height, width, at_poles=True)
    return np.repeat(rows[:, None], width, axis=1)


def median(values, weight):
    """The median of `values`, of which each counts by its `weight`; these add up to 1."""
    order = values.ravel().argsort()
    reached = weight.ravel()[order].cumsum()
    return float(values.ravel()[order][np.searchsorted(reached, 0.5)])


def shares(bright, weight):
    """Shares of the solid angle, the brightest first, and the shares of the light from there."""
    order = bright.ravel().argsort()[::-1]
    areas = np.append(0, weight.ravel()[order].cumsum())
    light = np.append(0, (weight * bright).ravel()[order].cumsum())
    return areas / areas[-1], light / light[-1]


def share_of_brightest(bright, weight, share):
    """The share of all light that comes from the brightest `share` of the solid angle."""
    return float(np.interp(share, *shares(bright, weight)))
