"""Measures of a shadow technique's quality: use of its texels, aliasing, flicker and acne."""

from collections.abc import Iterable
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray

BINS = 64  # bins along each side of a map: small ones, but with enough points in each of them
WHITE = 255.0  # the highest grey level


def share_of_texels_used(maps: Iterable[FloatArray], bins: int = BINS) -> float:
    """Return the share in (0, 1] of the shadow maps' area that visible points use.

    It is Q1 of [Ergun 2008, 3.2], and NaN if no point is on a map.

    maps : for each map, the coordinates (n, 2) of points on it; those outside [0, 1]² do not count.

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
    """Return the aliasing of a picture as one number [dB]; larger is better.

    It is Q2 of [Ergun 2008, 3.2]: a picture of the areas `e` of the texels under all visible points
    [pixels] is compared with a black one by PSNR, 10 log10(255² / mean e²). The thesis does not say
    how e becomes a grey level. Here e is the level, at most 255, which gives figures as printed (27
    to 37 dB). The result is NaN without points.

    >>> aliasing_error(np.full(9, 25.5))
    20.0
    """
    e = np.minimum(np.asarray(e, float), WHITE)
    return float(10 * np.log10(WHITE**2 / np.square(e).mean())) if e.size else np.nan


def flicker(lit: Any, true: Any) -> float:
    """Return the mean absolute change of the error from picture to picture, 0 at best.

    lit, true : shares of the light (pictures, points), by the technique and exact.

    >>> flicker([[1, 0], [0, 0]], [[1, 1], [1, 1]])
    0.5
    """
    errors = np.asarray(lit, float) - np.asarray(true, float)
    return float(np.abs(np.diff(errors, axis=0)).mean())


def acne(lit: AnyArray, exact: AnyArray, facing: AnyArray, margin: int) -> float:
    """Return the mean share of light that lit pixels lack, away from shadows [Ergun 2008, 3.1.2].

    lit : share (height, width) of the light by the technique.
    exact : whether the light arrives.
    facing : whether the surface faces the light.
    margin : number of pixels around shadows in which a soft border counts as no acne.
    """
    from scipy.ndimage import binary_dilation

    near: AnyArray = facing & ~exact
    if margin:
        near = binary_dilation(near, np.ones((3, 3), bool), margin)
    lacking = (1 - lit)[facing & exact & ~near]
    return float(lacking.mean()) if lacking.size else 0.0
