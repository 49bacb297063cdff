"""Linear sampling densities within the blocks of an environment map, fitted to the map's light.

Along an axis on which s runs from 0 to 1 through the block, the density is the block's mean times
1 + slope (s - 1/2); samples are drawn by the inverse of its integral. A block of one cell, such as
in a small sun, thus follows the map between its pixels, and a large one the gradient of a sky.
"""

import numpy as np

from brdfkit.core.array_types import FloatArray, IntArray, JitFloat
from brdfkit.lighting.sampling.tree import Sums

STEEPEST = 1.8  # largest slope; it leaves a tenth of a block's mean density at the darker end


def fit_slopes(sums: Sums, pixels: FloatArray, boxes: IntArray) -> FloatArray:
    """Fit the slopes (n, 2), across and down, of the densities in the blocks `boxes` (n, 4).

    `sums` gives sums of the power of a map's cells over boxes; `pixels` (rows, columns) is the
    power at the map's pixels.
    """
    x0, x1, y0, y1 = boxes.T
    closed = np.append(pixels, pixels[:, :1], axis=1)
    corners = np.stack([closed[y0, x0], closed[y0, x1], closed[y1, x0], closed[y1, x1]])
    across = _fit_slope(sums, boxes, 0, corners[[0, 2]].sum(axis=0), corners[[1, 3]].sum(axis=0))
    down = _fit_slope(sums, boxes, 2, corners[:2].sum(axis=0), corners[2:].sum(axis=0))
    return np.stack([across, down], axis=1)


def _fit_slope(
    sums: Sums, boxes: IntArray, axis: int, first: FloatArray, last: FloatArray
) -> FloatArray:
    """Fit the slopes (n,) of the blocks' densities along an axis.

    The blocks' bounds along it are the columns `axis` and `axis` + 1 of `boxes`. The power in the
    two halves of a block gives the slope; if the block is only one cell wide, the power of its
    `first` and `last` pixels does.
    """
    whole = sums.sum_values(boxes)
    start, end = boxes[:, axis], boxes[:, axis + 1]
    half = np.zeros(len(boxes))
    # Sum the first half of each block; of an odd number of cells, the middle one counts half
    for middle in ((start + end) // 2, (start + end + 1) // 2):
        part = boxes.copy()
        part[:, axis + 1] = middle
        half = half + sums.sum_values(part) / 2
    one = end - start == 1
    rise = np.where(one, 2 * (last - first), 4 * (whole - 2 * half))
    return (rise / np.maximum(np.where(one, first + last, whole), 1e-300)).clip(-STEEPEST, STEEPEST)


def line_density(s: JitFloat, slope: JitFloat) -> JitFloat:
    """Return the linear density of mean 1 with this `slope`, at 0 ≤ `s` ≤ 1 through a block."""
    return 1 + slope * (s - 0.5)


def sample_line_density(u: JitFloat, slope: JitFloat) -> JitFloat:
    """Draw 0 ≤ s ≤ 1 with the density `line_density(s, slope)`, by a uniform number `u`."""
    import drjit as dr

    start, end = line_density(0, slope), line_density(1, slope)
    return 2 * u / (start + dr.sqrt(dr.lerp(dr.square(start), dr.square(end), u)))
