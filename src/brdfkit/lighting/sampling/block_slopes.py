"""Densities that fall off within a block along straight lines, as the light of the map does.

Along an axis where s goes from 0 to 1 through the block, the density is 1 + slope (s - 1/2) times
the block's mean density; samples are drawn by the inverse of its integral. A block of one cell, as
in a small sun, thus follows the map between its pixels, and a large one the fall-off of a sky.
"""

import numpy as np

from brdfkit.core.array_types import FloatArray, IntArray, JitFloat
from brdfkit.lighting.sampling.tree import Sums

STEEPEST = 1.8  # the largest slope: the darker end of a line keeps a tenth of its mean


def fit_slopes(sums: Sums, pixels: FloatArray, boxes: IntArray) -> FloatArray:
    """Return the slopes (n, 2) across and down the blocks `boxes` (n, 4).

    `sums` are over the power of cells; `pixels` (rows, columns) is the power at pixels.
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
    """Return the slope (n,) along the axis whose bounds are columns `axis`, `axis` + 1 of `boxes`.

    The two halves of a line differ by a quarter of its slope. A block that is one cell wide has no
    halves; its line goes from its `first` pixels to its `last` ones.
    """
    whole = sums.sum_values(boxes)
    start, end = boxes[:, axis], boxes[:, axis + 1]
    half = np.zeros(len(boxes))
    for middle in ((start + end) // 2, (start + end + 1) // 2):  # a middle cell counts for both
        part = boxes.copy()
        part[:, axis + 1] = middle
        half = half + sums.sum_values(part) / 2
    one = end - start == 1
    rise = np.where(one, 2 * (last - first), 4 * (whole - 2 * half))
    return (rise / np.maximum(np.where(one, first + last, whole), 1e-300)).clip(-STEEPEST, STEEPEST)


def line_density(s: JitFloat, slope: JitFloat) -> JitFloat:
    """Return the density at 0 ≤ `s` ≤ 1 along a line of this `slope`, whose mean is 1."""
    return 1 + slope * (s - 0.5)


def draw_on_line(u: JitFloat, slope: JitFloat) -> JitFloat:
    """Return the place s that a uniform number `u` draws by `line_density`."""
    import drjit as dr

    start, end = line_density(0, slope), line_density(1, slope)
    return 2 * u / (start + dr.sqrt(dr.lerp(dr.square(start), dr.square(end), u)))
