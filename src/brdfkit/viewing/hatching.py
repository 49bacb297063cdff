"""Hatches what a picture shows without a measurement."""

import numpy as np

from brdfkit.core.array_types import AnyArray, BoolArray

STRIPES = 60  # over the longer side of the picture


def hatch(colours: AnyArray, mask: BoolArray) -> AnyArray:
    """Return a picture (height, width, 3), sRGB in 8 bits, with stripes where the mask is true."""
    height, width = mask.shape
    period = max(max(height, width) / STRIPES, 4)
    phase = (np.arange(height)[:, None] + np.arange(width)) % period / period
    hatched = colours.copy()
    hatched[mask & (phase < 0.25)] //= 3
    light = mask & (phase >= 0.25) & (phase < 0.5)
    hatched[light] = 255 - (255 - hatched[light]) // 3 * 2
    return hatched
