"""Downsampling of voxels: one voxel for each block of them."""

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray, IntArray


def reduce_slab(slab: AnyArray, factor: int, labels: bool) -> AnyArray:
    """Reduce a `slab` (nz, ny, nx) of up to `factor` layers to one layer (my, mx).

    A block of factor × factor × factor voxels becomes its mean in float32; `labels` become the
    voxel in the middle of their block.
    """
    if factor == 1:
        return slab[0]
    nz, ny, nx = slab.shape
    if labels:
        middle = factor // 2
        rows, columns = (np.minimum(np.arange(0, n, factor) + middle, n - 1) for n in (ny, nx))
        return slab[min(middle, nz - 1)][np.ix_(rows, columns)]
    rows, columns = np.arange(0, ny, factor), np.arange(0, nx, factor)
    sums = slab.sum(axis=0, dtype=float)
    sums = np.add.reduceat(np.add.reduceat(sums, rows, axis=0), columns, axis=1)
    count = nz * np.outer(_lengths(rows, ny), _lengths(columns, nx))
    return (sums / count).astype(np.float32)


def reduce_transform(to_world: FloatArray, factor: int) -> FloatArray:
    """Return the transform of voxels that represent blocks of `factor`³ voxels of `to_world`."""
    to_fine = np.diag([factor, factor, factor, 1.0])
    to_fine[:3, 3] = (factor - 1) / 2  # the middle of the first block
    return to_world @ to_fine


def reduce_shape(shape: tuple[int, int, int], factor: int) -> tuple[int, int, int]:
    """Return the shape of the blocks of voxels of this `shape`; the last ones may be smaller."""
    nz, ny, nx = (-(-n // factor) for n in shape)
    return nz, ny, nx


def _lengths(starts: IntArray, end: int) -> IntArray:
    """Return the lengths of consecutive intervals with these `starts`, up to `end`."""
    return np.diff(np.append(starts, end))
