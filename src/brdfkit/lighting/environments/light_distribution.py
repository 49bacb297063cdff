"""Statistics of the light in an environment map: pixel directions, solid angles, shares of light.

Maps are in Mitsuba's convention: latitude and longitude, with the first and last row at the poles.
"""

import numpy as np

from brdfkit.core.array_types import ArrayLike, FloatArray
from brdfkit.core.geometry import latitude_rows
from brdfkit.lighting.environments.conventions import parse_convention


def pixel_directions(
    height: int, width: int, dx: ArrayLike = 0.0, dy: ArrayLike = 0.0
) -> FloatArray:
    """Return the directions (height, width, 3) of the pixels, in a world with y up.

    `dx` and `dy` are offsets from the pixels' centres [pixels], and broadcast with the map.
    """
    mitsuba = parse_convention("mitsuba")
    x = np.arange(width)[None, :] + np.asarray(dx)
    y = np.arange(height)[:, None] + np.asarray(dy)
    return mitsuba.layout.directions(x, y, height, width) @ mitsuba.frame.T


def pixel_solid_angles(height: int, width: int) -> FloatArray:
    """Return the solid angles (height, width) [sr] of the pixels of an environment map."""
    rows = latitude_rows.solid_angles(height, width, at_poles=True)
    return np.repeat(rows[:, None], width, axis=1)


def weighted_median(values: FloatArray, weights: FloatArray) -> float:
    """Return the median of `values` with the `weights`, of the same shape, whose sum is 1."""
    order = values.ravel().argsort()
    cumulative = weights.ravel()[order].cumsum()
    return float(values.ravel()[order][np.searchsorted(cumulative, 0.5)])


def cumulative_light_shares(
    luminance: FloatArray, solid_angle: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return cumulative shares of the solid angle and of the light, for pixels sorted by luminance.

    Both (n + 1,) begin at 0, and add one of the n pixels after the other, the brightest first.
    """
    order = luminance.ravel().argsort()[::-1]
    areas = np.append(0, solid_angle.ravel()[order].cumsum())
    light = np.append(0, (solid_angle * luminance).ravel()[order].cumsum())
    return areas / areas[-1], light / light[-1]


def share_of_brightest(luminance: FloatArray, solid_angle: FloatArray, share: float) -> float:
    """Return the share of the light that comes from the brightest `share` of the solid angle."""
    return float(np.interp(share, *cumulative_light_shares(luminance, solid_angle)))
