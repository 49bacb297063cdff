"""Computes the peak signal-to-noise ratio (PSNR) of a picture."""

from math import inf, nan

import numpy as np

from brdfkit.core.array_types import AnyArray, BoolArray
from brdfkit.images.errors.masks import to_mask

PEAK = 99.9  # percentile of the reference, so that a single firefly does not set the peak


def find_peak(reference: AnyArray, mask: BoolArray | None = None) -> float:
    """Return the 99.9th percentile of a reference (height, width, 3), in the mask (height, width).

    nan for an empty mask.

    >>> find_peak(np.full((4, 4, 3), 0.5))
    0.5
    """
    values = reference[to_mask(reference, mask)]
    return float(np.percentile(values, PEAK)) if values.size else nan


def psnr(
    reference: AnyArray,
    picture: AnyArray,
    mask: BoolArray | None = None,
    peak: float | None = None,
) -> float:
    """Return 10·log10(peak² / mean squared difference) [dB] over all channels.

    The pictures are (height, width, 3), the mask (height, width); `peak` is by default
    `find_peak` of the reference. inf for equal pictures, nan for an empty mask.

    >>> psnr(np.full((4, 4, 3), 0.5), np.full((4, 4, 3), 0.45))
    20.0
    """
    mask = to_mask(reference, mask)
    if not mask.any():
        return nan
    error = np.square(picture[mask] - reference[mask], dtype=float).mean()
    peak = find_peak(reference, mask) if peak is None else peak
    with np.errstate(divide="ignore"):  # -inf for a black reference
        return float(10 * np.log10(peak**2 / error)) if error else inf
