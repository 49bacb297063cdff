"""Peak signal-to-noise ratio."""

from math import inf, nan

import numpy as np

from brdfkit.images.errors.masks import counted

PEAK = 99.9  # percentile of the reference: a single firefly is no peak


def peak(reference, mask=None):
    """The value of the `reference` that counts as its brightest, by default of all pixels.

    nan for an empty mask.

    >>> peak(np.full((4, 4, 3), 0.5))
    0.5
    """
    seen = reference[counted(reference, mask)]
    return float(np.percentile(seen, PEAK)) if seen.size else nan


def psnr(reference, picture, mask=None):
    """10·log10(peak² / mean squared difference) [dB] over all channels; inf for equal pictures.

    nan for an empty mask.

    >>> psnr(np.full((4, 4, 3), 0.5), np.full((4, 4, 3), 0.45))
    20.0
    """
    mask = counted(reference, mask)
    if not mask.any():
        return nan
    error = np.square(picture[mask] - reference[mask], dtype=float).mean()
    with np.errstate(divide="ignore"):  # a black reference: -inf
        return float(10 * np.log10(peak(reference, mask) ** 2 / error)) if error else inf
