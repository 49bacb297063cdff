"""Hatches what a picture shows without a measurement: densely what is guessed, else sparsely."""

import numpy as np

from brdfkit.core.array_types import AnyArray

STRIPES = 60  # over the longer side of the picture
SPARSE = 1  # the level of what was inferred from measurements; guesses have a larger one


def hatch(colours: AnyArray, mask: AnyArray) -> AnyArray:
    """Return a picture (height, width, 3), sRGB in 8 bits, with stripes where the mask is true.

    A `mask` of whole numbers is 0 where nothing is hatched, 1 where thin stripes are far apart and
    run the other way, and larger where stripes are dense.
    """
    dense = mask if mask.dtype == bool else mask > SPARSE
    height, width = mask.shape
    period = max(max(height, width) / STRIPES, 4)
    rows, columns = np.arange(height)[:, None], np.arange(width)
    phase = (rows + columns) % period / period
    hatched = colours.copy()
    hatched[dense & (phase < 0.25)] //= 3
    light = dense & (phase >= 0.25) & (phase < 0.5)
    hatched[light] = 255 - (255 - hatched[light]) // 3 * 2
    if mask.dtype != bool:
        sparse, across = mask == SPARSE, (rows - columns) % (3 * period) / (3 * period)
        hatched[sparse & (across < 0.08)] //= 2
        light = sparse & (across >= 0.08) & (across < 0.16)
        hatched[light] = 255 - (255 - hatched[light]) // 2
    return hatched
