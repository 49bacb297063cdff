"""Upper bounds of a transfer function within blocks of voxels, for tracking collisions."""

from collections.abc import Callable

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray

BLOCK_VOXELS = 8  # along the side of a block, about
NEARBY = 0.01  # voxels from the edge of a block within which rounding decides on a point's block
SLACK = 1e-3  # steps of the table, for the single precision of kernels; and 1e-6 of the bound


def block_ranges(values: AnyArray) -> tuple[AnyArray, AnyArray]:
    """Return the smallest and the largest value (kz, ky, kx) of a volume within each block.

    The box of `values` (nz, ny, nx) is divided into equal blocks of about BLOCK_VOXELS voxels.
    Between the centres of voxels, values are trilinear or those of the nearest voxel.
    """
    low = high = values
    for axis, n in enumerate(values.shape):
        count = max(1, n // BLOCK_VOXELS)
        low, high = (
            reduce_blocks(low, axis, count, np.min),
            reduce_blocks(high, axis, count, np.max),
        )
    return low, high


def reduce_blocks(
    values: AnyArray, axis: int, count: int, reduce: Callable[..., AnyArray]
) -> AnyArray:
    """Reduce each of `count` equal blocks along an axis by np.min or np.max.

    A block includes the centres on both sides of its ends, between which values are interpolated.
    """
    n = values.shape[axis]
    edges = np.arange(count + 1) * n / count - 0.5  # in voxels, whose centres are whole numbers
    first = np.clip(np.floor(edges[:-1] - NEARBY), 0, n - 1).astype(int)
    last = np.clip(np.ceil(edges[1:] + NEARBY), 0, n - 1).astype(int)
    blocks = (values.take(range(a, b + 1), axis) for a, b in zip(first, last, strict=True))
    return np.stack([reduce(block, axis) for block in blocks], axis)


def bound_between(rows: FloatArray, low: FloatArray, high: FloatArray) -> FloatArray:
    """Return the largest value of a piecewise linear function between `low` and `high`.

    `rows` (n,) are its values at 0, 1 ... n - 1; it is constant beyond. `low` and `high` have one
    shape. The bound is exact except for the SLACK.

    >>> bound_between(np.array([0.0, 4.0, 2.0]), np.array([0.5, 1.5]), np.array([1.2, 9.0]))
    array([4.000004, 3.002003])
    """
    n = len(rows)
    low, high = np.clip(low - SLACK, 0, n - 1), np.clip(high + SLACK, 0, n - 1)
    at_ends = np.maximum(*(np.interp(x, np.arange(n), rows) for x in (low, high)))

    # Row k holds the largest of 2^k values from each one on; two of them cover all rows between
    powers = [rows]
    while 2 ** len(powers) <= n:
        half = 2 ** (len(powers) - 1)
        later = np.append(powers[-1][half:], np.full(half, -np.inf))
        powers.append(np.maximum(powers[-1], later))
    first, last = np.ceil(low).astype(int), np.floor(high).astype(int)
    k = np.log2(np.maximum(last - first + 1, 1)).astype(int)
    table = np.stack(powers)
    within = np.maximum(
        table[k, np.minimum(first, n - 1)], table[k, np.maximum(last + 1 - 2**k, 0)]
    )
    return np.where(first <= last, np.maximum(at_ends, within), at_ends) * (1 + 1e-6)
