"""The peak signal-to-noise ratio (PSNR) of a picture, with a peak that ignores fireflies."""

from math import inf, nan

import numpy as np

from brdfkit.core.array_types import AnyArray, BoolArray
from brdfkit.images.errors.masks import make_mask

PEAK = 99.9  # percentile of the reference that is the peak, so that fireflies do not determine it


def find_peak(reference: AnyArray, mask: BoolArray | None = None) -> float:
    """Return the peak for PSNR: the 99.9th percentile of the reference's values within the mask.

    The reference is (height, width, 3), the mask (height, width). An empty mask gives nan.

    >>> find_peak(np.full((4, 4, 3), 0.5))
    0.5
    """
    values = reference[make_mask(reference, mask)]
    return float(np.percentile(values, PEAK)) if values.size else nan


def psnr(
    reference: AnyArray,
    picture: AnyArray,
    mask: BoolArray | None = None,
    peak: float | None = None,
) -> float:
    """Return the PSNR [dB] of a picture: 10·log10(peak² / mean squared difference).

    The pictures are (height, width, 3), the mask (height, width); the mean is over all channels of
    its pixels. `peak` is by default `find_peak(reference, mask)`. The result is inf for equal
    pictures, nan for an empty mask.

    >>> psnr(np.full((4, 4, 3), 0.5), np.full((4, 4, 3), 0.45))
    20.0
    """
    mask = make_mask(reference, mask)
    if not mask.any():
        return nan
    error = np.square(picture[mask] - reference[mask], dtype=float).mean()
    peak = find_peak(reference, mask) if peak is None else peak
    with np.errstate(divide="ignore"):  # a black reference has log10(0) = -inf
        return float(10 * np.log10(peak**2 / error)) if error else inf
