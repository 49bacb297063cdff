"""HDR-FLIP: the visible difference when flipping between two pictures [Andersson et al. 2021].

The package flip-evaluator computes this metric at several exposures. By itself it would choose them
from all pixels, and a black background would lead to too many and too long exposures. Here they are
chosen from the pixels of the mask alone.
"""

from math import ceil

import numpy as np

from brdfkit.core.array_types import AnyArray, BoolArray
from brdfkit.core.colours import luminance
from brdfkit.images.errors.masks import crop_to_mask
from brdfkit.images.errors.psnr import PEAK

# The shortest exposure brings the brightest pixel to this value, and the longest one the median
# pixel. It is the value at which the tone curve of ACES reaches 0.85 of its range
EXPOSED_VALUE = 2.1188
# Largest range of exposures [stops], since a median of 0 would make the range infinite
LARGEST_RANGE = 8


def flip(reference: AnyArray, picture: AnyArray, mask: BoolArray) -> float:
    """Return the mean error HDR-FLIP over the mask, from 0 for equal pictures to 1.

    It assumes 67 pixels per degree of the visual field. The result is nan for a black reference.
    Raises `ImportError` without the package flip-evaluator.
    """
    from flip_evaluator import evaluate

    start, stop = find_exposures(reference, mask)
    if not np.isfinite(start):
        return np.nan
    pictures, inside = crop_to_mask([np.maximum(p, 0) for p in (reference, picture)], mask)
    settings = {
        "startExposure": start,
        "stopExposure": stop,
        "numExposures": max(2, ceil(stop - start)),
        "tonemapper": "ACES",
    }
    single = [np.ascontiguousarray(p, np.float32) for p in pictures]
    errors, _, _ = evaluate(*single, "HDR", applyMagma=False, parameters=settings)
    return float(errors[inside].mean(dtype=float))


def find_exposures(reference: AnyArray, mask: BoolArray) -> tuple[float, float]:
    """Return the shortest and the longest exposure [stops] at which FLIP compares pictures.

    The pixels of the reference within the mask determine them; they are inf if it is black.
    """
    values = luminance(np.maximum(reference[mask], 0))
    brightest, median = np.percentile(values, [PEAK, 50])
    with np.errstate(divide="ignore"):
        start, stop = np.log2(EXPOSED_VALUE) - np.log2([brightest, median])
    return float(start), float(min(stop, start + LARGEST_RANGE))
