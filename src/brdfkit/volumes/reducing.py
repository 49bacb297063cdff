"""Makes fewer voxels of many: one for each block of them."""

import numpy as np


def reduced(slab, factor, labels):
    """A layer (my, mx) of voxels from a `slab` (nz, ny, nx) of up to `factor` layers.

    The mean of each block in float32; of `labels` the voxel at its middle.
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


def transform(to_world, factor):
    """The transform of voxels that stand for blocks of `factor`³ voxels of `to_world`."""
    to_fine = np.diag([factor, factor, factor, 1.0])
    to_fine[:3, 3] = (factor - 1) / 2  # the middle of the first block
    return to_world @ to_fine


def shape(fine, factor):
    """The shape of what is left of the shape `fine`."""
    return tuple(-(-n // factor) for n in fine)


def _lengths(starts, end):
    return np.diff(np.append(starts, end))
