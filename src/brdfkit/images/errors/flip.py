"""HDR-FLIP: what an observer sees who flips between two pictures [Andersson et al. 2021].

The package flip-evaluator computes it. Left alone, it takes the exposures from all pixels, of which
a black background makes too many and too long ones; here they come from the masked ones.
"""

from math import ceil

import numpy as np

from brdfkit.core.colours import luminance
from brdfkit.images.errors.masks import crop_to_mask
from brdfkit.images.errors.psnr import PEAK

# The exposures lift the brightest pixel, and the median one, to this value, where the tone curve of
# ACES comes to 0.85 of its range
BRIGHT = 2.1188
STOPS = 8  # between the shortest and the longest exposure, at most: half of the pixels may be black


def flip(reference, picture, mask):
    """The mean of HDR-FLIP over the mask, 0 (equal) to 1, at 67 pixels per degree of the eye.

    Raises `ImportError` without the package flip-evaluator. nan for a black reference.
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


def find_exposures(reference, mask):
    """The shortest and the longest exposure [stops] for a reference; inf for a black one."""
    seen = luminance(np.maximum(reference[mask], 0))
    brightest, median = np.percentile(seen, [PEAK, 50])
    with np.errstate(divide="ignore"):
        start, stop = np.log2(BRIGHT) - np.log2([brightest, median])
    return float(start), float(min(stop, start + STOPS))
