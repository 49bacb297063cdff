"""How light falls off within a block: a straight line along each axis, in place of an even density.

Along an axis, where s goes from 0 to 1 through the block, the density is 1 + slope (s - 1/2) times
the block's own; a sample is drawn by the inverse of the integral. So blocks of one cell, as a small
sun has them, follow the map between pixels, and larger ones the falling off of a sky.
"""

import numpy as np

STEEPEST = 1.8  # a line ends at a tenth of its mean at least, however the light falls


def slopes(sums, pixels, boxes):
    """The slopes (n, 2) across and down the `boxes` (n, 4) of cells.

    `sums` are those of the power of cells, `pixels` (rows, columns) is the power at pixels.
    """
    x0, x1, y0, y1 = boxes.T
    closed = np.append(pixels, pixels[:, :1], axis=1)
    corners = np.stack([closed[y0, x0], closed[y0, x1], closed[y1, x0], closed[y1, x1]])
    across = _slope(sums, boxes, 0, corners[[0, 2]].sum(axis=0), corners[[1, 3]].sum(axis=0))
    down = _slope(sums, boxes, 2, corners[:2].sum(axis=0), corners[2:].sum(axis=0))
    return np.stack([across, down], axis=1)


def _slope(sums, boxes, axis, first, last):
    """The slope (n,) along the axis whose bounds are the columns `axis` and `axis` + 1 of `boxes`.

    The halves of a line differ by a quarter of its slope. A block that is one cell wide is not
    halved, but goes from its `first` pixels to its `last` ones.
    """
    whole = sums.of_values(boxes)
    start, end = boxes[:, axis], boxes[:, axis + 1]
    half = 0
    for middle in ((start + end) // 2, (start + end + 1) // 2):  # a middle cell counts for both
        part = boxes.copy()
        part[:, axis + 1] = middle
        half = half + sums.of_values(part) / 2
    one = end - start == 1
    rise = np.where(one, 2 * (last - first), 4 * (whole - 2 * half))
    return (rise / np.maximum(np.where(one, first + last, whole), 1e-300)).clip(-STEEPEST, STEEPEST)


def line(s, slope):
    """The density at 0 ≤ `s` ≤ 1, of mean 1."""
    return 1 + slope * (s - 0.5)


def draw(u, slope):
    """The place s of a uniform number `u` by the density `line`."""
    import drjit as dr

    start, end = line(0, slope), line(1, slope)
    return 2 * u / (start + dr.sqrt(dr.lerp(dr.square(start), dr.square(end), u)))
