"""Measures of a shadow technique's quality: use of its texels, aliasing, flicker and acne."""

from collections.abc import Iterable
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray

BINS = 64  # bins along a side of a map, so few that each bin has enough points
WHITE = 255.0  # largest grey level of a picture


def share_of_texels_used(maps: Iterable[FloatArray], bins: int = BINS) -> float:
    """Return the share in (0, 1] of the shadow maps' area that visible points use.

    It is the measure Q1 of [Ergun 2008, 3.2], and NaN if no point is on a map.

    maps : for each map, the coordinates (n, 2) of the visible points on it; those outside [0, 1]²
        do not count.
    bins : number of bins along a side of a map in which points are counted.

    >>> share_of_texels_used([np.array([[0.2, 0.2], [0.7, 0.2]])], bins=2)
    0.5
    """
    limits = [[0, 1]] * 2
    histograms = [np.histogram2d(p[:, 0], p[:, 1], bins, limits)[0] for p in maps]
    counts = np.stack(histograms)
    if not counts.any():
        return np.nan
    return float(counts.sum() ** 2 / (counts.size * np.square(counts).sum()))


def aliasing_error(e: Any) -> float:
    """Return how small the texels are in a picture, as one number [dB]; larger is better.

    It is the measure Q2 of [Ergun 2008, 3.2], 10 log10(255² / mean e²): the PSNR between a black
    picture and one whose grey levels are the texels' areas e. The thesis does not say how an area
    becomes a grey level. Here it is the level, at most 255, which gives values like those in the
    thesis (27 to 37 dB).

    e : area in the picture [pixels] of the texel at each visible point; without points, the result
        is NaN.

    >>> aliasing_error(np.full(9, 25.5))
    20.0
    """
    e = np.minimum(np.asarray(e, float), WHITE)
    return float(10 * np.log10(WHITE**2 / np.square(e).mean())) if e.size else np.nan


def measure_flicker(lit: Any, true: Any) -> float:
    """Return the mean absolute change of a technique's error between successive pictures.

    lit, true : share of the light that arrives at each point (pictures, points): with the
        technique, and in truth. The error is their difference.

    >>> measure_flicker([[1, 0], [0, 0]], [[1, 1], [1, 1]])
    0.5
    """
    errors = np.asarray(lit, float) - np.asarray(true, float)
    return float(np.abs(np.diff(errors, axis=0)).mean())


def acne(lit: AnyArray, exact: AnyArray, facing: AnyArray, margin: int) -> float:
    """Return the mean share of light that lit pixels wrongly lack, away from true shadows.

    Surfaces that shadow themselves cause this [Ergun 2008, 3.1.2].

    lit : share (height, width) of the light that arrives with the technique.
    exact : True in pixels (height, width) where the light arrives in truth.
    facing : True in pixels (height, width) whose surface faces the light.
    margin : width [pixels] around shadows that does not count, as soft borders may darken it.
    """
    from scipy.ndimage import binary_dilation

    near: AnyArray = facing & ~exact
    if margin:
        near = binary_dilation(near, np.ones((3, 3), bool), margin)
    lacking = (1 - lit)[facing & exact & ~near]
    return float(lacking.mean()) if lacking.size else 0.0
