"""Upper bounds of a transfer function in blocks of voxels, as majorants for tracking collisions."""

from collections.abc import Callable

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray

BLOCK_VOXELS = 8  # approximate number of voxels along the edge of a block
NEARBY = 0.01  # blocks overlap by so many voxels, since rounding may put a point in the next block
SLACK = 1e-3  # steps of a table by which a renderer's single precision may miss a value


def find_block_ranges(values: AnyArray) -> tuple[AnyArray, AnyArray]:
    """Return the smallest and the largest value of a volume in each block, two arrays (kz, ky, kx).

    The box of the volume with voxels `values` (nz, ny, nx) is divided into equal blocks, about
    BLOCK_VOXELS voxels along each edge. Interpolated values between voxels are included.
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
    """Reduce voxels `values` to their minimum or maximum in `count` equal blocks along an axis.

    `reduce` is np.min or np.max. A block includes the voxels on both sides of its ends, between
    which values are interpolated.
    """
    n = values.shape[axis]
    edges = np.arange(count + 1) * n / count - 0.5  # voxels have their centres at whole numbers
    first = np.clip(np.floor(edges[:-1] - NEARBY), 0, n - 1).astype(int)
    last = np.clip(np.ceil(edges[1:] + NEARBY), 0, n - 1).astype(int)
    along = np.moveaxis(values, axis, 0)
    blocks = (along[a : b + 1] for a, b in zip(first, last, strict=True))
    return np.stack([reduce(block, 0) for block in blocks], axis)


def bound_piecewise_linear(rows: FloatArray, low: FloatArray, high: FloatArray) -> FloatArray:
    """Return an upper bound of a piecewise linear function in each interval from `low` to `high`.

    `rows` (n,) are the function's values at 0, 1 ... n - 1, beyond which it is constant. `low` and
    `high` have one shape, which the result has as well. The intervals are widened by SLACK, and the
    bound is 1e-6 above the largest value.

    >>> low, high = np.array([0.5, 1.5]), np.array([1.2, 9.0])
    >>> bound_piecewise_linear(np.array([0.0, 4.0, 2.0]), low, high)
    array([4.000004, 3.002003])
    """
    n = len(rows)
    low, high = np.clip(low - SLACK, 0, n - 1), np.clip(high + SLACK, 0, n - 1)
    at_ends = np.maximum(*(np.interp(x, np.arange(n), rows) for x in (low, high)))

    # powers[k][i] is the largest of the 2^k rows from i on; two such maxima cover any interval
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
