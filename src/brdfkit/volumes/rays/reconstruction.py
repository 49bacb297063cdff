"""A volume between its voxels: trilinear or nearest values, and gradients by two rules.

The reference for what renderers do, in NumPy and double precision. Voxels of index (i, j, k) have
their centres at whole numbers; from -½ to n - ½ is the box of the volume.
"""

import math

import numpy as np

from brdfkit.core.geometry.multilinear import find_bracket, list_corners

LAYERS = 16  # of which gradients are taken at a time


def values_at(volume, points):
    """The values (n,) at `points` (n, 3) of the world; 0 outside of the box."""
    return _values(volume, _indices(volume, points))


def gradient_at(volume, points, of_interpolant):
    """∇V (n, 3) at `points` (n, 3) of the world; see `Volume.gradient`."""
    indices = _indices(volume, points)
    by_index = _slopes(volume, indices) if of_interpolant else _differences(volume, indices)
    # the chain rule: by the world's axes, what it is by the grid's
    return by_index @ np.linalg.inv(volume.to_world[:3, :3])


def gradient_magnitude(values, to_world):
    """‖∇V‖ (nz, ny, nx) at the centres of voxels, by central differences."""
    result = np.empty(values.shape, np.float32)
    to_indices = np.linalg.inv(to_world[:3, :3])
    metric = to_indices @ to_indices.T  # diagonal, unless the axes are oblique to each other
    # A power of two, by which division is exact: squares of large values have no room in 32 bits
    largest = max(1.0, float(values.max()), -float(values.min()))
    unit = np.float32(2.0 ** math.floor(math.log2(largest)))
    for k in range(0, len(values), LAYERS):
        before, behind = min(k, 1), k + LAYERS + 1
        slab = values[k - before : behind].astype(np.float32) / unit
        square = _square(slab, metric)[before : before + LAYERS]
        result[k : k + LAYERS] = unit * np.sqrt(np.maximum(square, 0))
    return result


def _square(values, metric):
    """g · metric · g at each voxel, of the differences g along x, y, z."""
    slopes = [
        np.gradient(values, axis=axis) if values.shape[axis] > 1 else np.zeros_like(values)
        for axis in (2, 1, 0)
    ]
    pairs = [(a, b) for a in range(3) for b in range(3) if metric[a, b]]
    return sum(np.float32(metric[a, b]) * slopes[a] * slopes[b] for a, b in pairs)


def _indices(volume, points):
    """The places (n, 3) of `points` of the world in the grid, in x, y, z."""
    points = np.atleast_2d(np.asarray(points, float))
    to_indices = np.linalg.inv(volume.to_world)
    return points @ to_indices[:3, :3].T + to_indices[:3, 3]


def _values(volume, indices):
    if volume.labels:
        nearest = np.rint(indices).astype(int)
        k, j, i = (np.clip(nearest[:, axis], 0, volume.size[axis] - 1) for axis in (2, 1, 0))
        found = volume.values[k, j, i]
    else:
        found = _interpolated(volume, indices)
    return np.where(_is_inside(volume, indices), found, 0)


def _interpolated(volume, indices):
    """The trilinear interpolant, which goes on beyond the outermost centres as it is there."""
    axes = [find_bracket(indices[:, axis], volume.size[axis]) for axis in (2, 1, 0)]
    return sum(share * volume.values[cells].astype(float) for cells, share in list_corners(axes))


def _differences(volume, indices):
    """(V(p + e) - V(p - e)) / 2 along each axis of the grid."""
    steps = np.eye(3)
    ahead = [_interpolated(volume, indices + step) for step in steps]
    behind = [_interpolated(volume, indices - step) for step in steps]
    return (np.stack(ahead, axis=1) - np.stack(behind, axis=1)) / 2


def _slopes(volume, indices):
    """The derivative of the trilinear interpolant by its three arguments.

    Along an axis it is linear, so that its slope is the difference of the two ends of the cell.
    """
    result = np.zeros_like(indices)
    for axis, n in enumerate(volume.size):
        low, _, _ = find_bracket(indices[:, axis], n)
        ends = [indices.copy(), indices.copy()]
        ends[0][:, axis], ends[1][:, axis] = low, low + 1
        moves = (indices[:, axis] > 0) & (indices[:, axis] < n - 1)  # constant beyond the centres
        slope = _interpolated(volume, ends[1]) - _interpolated(volume, ends[0])
        result[:, axis] = np.where(moves, slope, 0)
    return result


def _is_inside(volume, indices):
    return ((indices >= -0.5) & (indices <= np.array(volume.size) - 0.5)).all(axis=1)
