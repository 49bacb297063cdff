"""Downsampling of volumes: each cubic block of voxels becomes one larger voxel."""

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray, IntArray


def downsample_slab(slab: AnyArray, factor: int, labels: bool) -> AnyArray:
    """Downsample a `slab` (nz, ny, nx) of voxels, at most `factor` layers, to one layer (my, mx).

    Each block of `factor` voxels along each axis becomes one voxel, with the block's mean in
    float32. If the values are `labels`, which have no mean, it is the voxel in the block's middle.
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
    count = nz * np.outer(_interval_lengths(rows, ny), _interval_lengths(columns, nx))
    return (sums / count).astype(np.float32)


def downsample_transform(to_world: FloatArray, factor: int) -> FloatArray:
    """Return the transform (4, 4) from indices of downsampled voxels to the world.

    `to_world` (4, 4) is the transform of the original voxels, `factor` their number along the edge
    of a downsampled one.
    """
    to_fine = np.diag([factor, factor, factor, 1.0])
    to_fine[:3, 3] = (factor - 1) / 2  # the first block's centre, in original indices
    return to_world @ to_fine


def downsample_shape(shape: tuple[int, int, int], factor: int) -> tuple[int, int, int]:
    """Return the shape (nz, ny, nx) that a grid of this `shape` has after downsampling.

    `factor` is the number of voxels along each axis that become one.
    """
    nz, ny, nx = (-(-n // factor) for n in shape)
    return nz, ny, nx


def _interval_lengths(starts: IntArray, end: int) -> IntArray:
    """Return the lengths (n,) of consecutive intervals from their `starts` (n,) and the last `end`.

    They are the numbers of voxels in blocks, of which the last may be smaller.
    """
    return np.diff(np.append(starts, end))
