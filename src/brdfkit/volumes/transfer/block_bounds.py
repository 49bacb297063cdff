"""Bounds of what a transfer function gives within blocks of voxels, for tracking and skipping."""

import numpy as np

BLOCK = 8  # voxels along the side of a block, about
NEARBY = 0.01  # [voxel]: a point at the edge of a block belongs to either block, by rounding
SLACK = 1e-3  # steps of the table, and 1e-6 of the bound: a kernel's single precision


def block_ranges(values):
    """The least and the largest value (kz, ky, kx) that a volume has within each block.

    values : (nz, ny, nx). The box of all voxels is cut into equal blocks of about BLOCK voxels.
        Between the centres of voxels the values are trilinear, or those of the nearest.
    """
    low = high = values
    for axis, n in enumerate(values.shape):
        count = max(1, n // BLOCK)
        low, high = along_blocks(low, axis, count, np.min), along_blocks(high, axis, count, np.max)
    return low, high


def along_blocks(values, axis, count, reduce):
    """`reduce`, np.min or np.max, of the voxels by which points of each of `count` equal blocks
    along an axis are interpolated: the centres on both sides of its ends, too."""
    n = values.shape[axis]
    edges = np.arange(count + 1) * n / count - 0.5  # in voxels, whose centres are whole numbers
    first = np.clip(np.floor(edges[:-1] - NEARBY), 0, n - 1).astype(int)
    last = np.clip(np.ceil(edges[1:] + NEARBY), 0, n - 1).astype(int)
    blocks = (values.take(range(a, b + 1), axis) for a, b in zip(first, last, strict=True))
    return np.stack([reduce(block, axis) for block in blocks], axis)


def largest_between(rows, low, high):
    """The largest value of a piecewise linear function from `low` to `high`, arrays of one shape.

    rows : (n,), its values at 0, 1 ... n - 1, constant beyond. Exact, but for the SLACK.

    >>> largest_between(np.array([0.0, 4.0, 2.0]), np.array([0.5, 1.5]), np.array([1.2, 9.0]))
    array([4.000004, 3.002003])
    """
    n = len(rows)
    low, high = np.clip(low - SLACK, 0, n - 1), np.clip(high + SLACK, 0, n - 1)
    at_ends = np.maximum(*(np.interp(x, np.arange(n), rows) for x in (low, high)))

    # Row k holds the largest of 2^k values from each on; two of them cover all rows between
    powers = [rows]
    while 2 ** len(powers) <= n:
        half = 2 ** (len(powers) - 1)
        later = np.append(powers[-1][half:], np.full(half, -np.inf))
        powers.append(np.maximum(powers[-1], later))
    first, last = np.ceil(low).astype(int), np.floor(high).astype(int)
    k = np.log2(np.maximum(last - first + 1, 1)).astype(int)
    powers = np.stack(powers)
    within = np.maximum(
        powers[k, np.minimum(first, n - 1)], powers[k, np.maximum(last + 1 - 2**k, 0)]
    )
    return np.where(first <= last, np.maximum(at_ends, within), at_ends) * (1 + 1e-6)
