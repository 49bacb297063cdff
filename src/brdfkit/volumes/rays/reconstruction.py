"""Reconstruction of a volume between its voxels: values, trilinear or nearest, and gradients.

This is the reference for renderers, in NumPy and double precision. Indices are coordinates of the
grid, also between voxels: the centre of voxel (i, j, k) has these whole numbers, and the box of the
volume reaches from -½ to n - ½ along an axis of n voxels.
"""

import itertools
import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from brdfkit.core.array_types import AnyArray, ArrayLike, BoolArray, FloatArray
from brdfkit.core.geometry.multilinear import find_bracket, list_corners

Volume = Any  # the class in `volume.py`; its import would be circular

LAYERS, ROWS = 16, 32  # of voxels whose gradients are computed at a time, in the processor's cache


def interpolate_values(volume: Volume, points: ArrayLike) -> AnyArray:
    """Return the volume's values (n,) at `points` (n, 3) of the world; 0 outside its box.

    Labels are taken from the nearest voxel, other values interpolated trilinearly.
    """
    indices = _convert_to_indices(volume, points)
    if volume.labels:
        nearest = np.rint(indices).astype(int)
        k, j, i = (np.clip(nearest[:, axis], 0, volume.size[axis] - 1) for axis in (2, 1, 0))
        values = volume.values[k, j, i]
    else:
        values = _interpolate_trilinearly(volume, indices)
    return np.where(_is_inside_box(volume, indices), values, 0)


def compute_gradients(volume: Volume, points: ArrayLike, of_interpolant: bool) -> AnyArray:
    """Return the gradients (n, 3) of a volume's values at `points` (n, 3) of the world.

    They are derivatives of the trilinear interpolant if `of_interpolant`, otherwise central
    differences.
    """
    indices = _convert_to_indices(volume, points)
    differentiate = _interpolant_slopes if of_interpolant else _central_differences
    by_index = differentiate(volume, indices)
    # The chain rule converts derivatives along the grid's axes to those along the world's
    return by_index @ np.linalg.inv(volume.to_world[:3, :3])


def gradient_magnitude(values: AnyArray, to_world: FloatArray) -> NDArray[np.float32]:
    """Return the gradient magnitude (nz, ny, nx) at the voxels' centres, by central differences.

    `to_world` (4, 4) is the transform from indices of voxels to the world.
    """
    result = np.empty(values.shape, np.float32)
    to_indices = np.linalg.inv(to_world[:3, :3])
    metric = to_indices @ to_indices.T  # diagonal if the grid's axes are at right angles
    # Large values are divided by a unit, so that their squares fit into float32. It is a power of
    # two, so that no digits are lost
    largest = max(1.0, float(values.max()), -float(values.min()))
    unit = np.float32(2.0 ** math.floor(math.log2(largest)))
    for k, j in itertools.product(range(0, len(values), LAYERS), range(0, values.shape[1], ROWS)):
        first, start = max(k - 1, 0), max(j - 1, 0)  # with the neighbours, where there are any
        block = values[first : k + LAYERS + 1, start : j + ROWS + 1].astype(np.float32) / unit
        square = _squared_gradient_lengths(block, metric)
        square = square[k - first : k - first + LAYERS, j - start : j - start + ROWS]
        result[k : k + LAYERS, j : j + ROWS] = unit * np.sqrt(np.maximum(square, 0))
    return result


def _squared_gradient_lengths(values: AnyArray, metric: FloatArray) -> FloatArray:
    """Return the squared gradient magnitude gᵀ M g at each voxel of a block of `values`.

    g are the central differences along the grid's axes, and the `metric` M (3, 3) converts their
    squares to the world.
    """
    slopes = [
        np.gradient(values, axis=axis) if values.shape[axis] > 1 else np.zeros_like(values)
        for axis in (2, 1, 0)
    ]
    pairs = [(a, b) for a in range(3) for b in range(3) if metric[a, b]]
    products = (np.float32(metric[a, b]) * slopes[a] * slopes[b] for a, b in pairs)
    return sum(products, np.zeros((), np.float32))


def _convert_to_indices(volume: Volume, points: ArrayLike) -> FloatArray:
    """Convert `points` (n, 3) of the world to fractional indices (n, 3) of the grid, x first."""
    points = np.atleast_2d(np.asarray(points, float))
    to_indices = np.linalg.inv(volume.to_world)
    return points @ to_indices[:3, :3].T + to_indices[:3, 3]


def _interpolate_trilinearly(volume: Volume, indices: FloatArray) -> FloatArray:
    """Interpolate the volume trilinearly at `indices` (n, 3) of the grid; return the values (n,).

    Beyond the centres of the outermost voxels the values are constant.
    """
    axes = [find_bracket(indices[:, axis], volume.size[axis]) for axis in (2, 1, 0)]
    parts = (share * volume.values[cells].astype(float) for cells, share in list_corners(axes))
    return sum(parts, np.zeros(()))


def _central_differences(volume: Volume, indices: FloatArray) -> FloatArray:
    """Return the central differences (n, 3) of the interpolated values along the grid's axes.

    They are (V(p + e) - V(p - e)) / 2 for the values V at `indices` p (n, 3), and each unit step e.
    """
    steps = np.eye(3)
    ahead = [_interpolate_trilinearly(volume, indices + step) for step in steps]
    behind = [_interpolate_trilinearly(volume, indices - step) for step in steps]
    return (np.stack(ahead, axis=1) - np.stack(behind, axis=1)) / 2


def _interpolant_slopes(volume: Volume, indices: FloatArray) -> FloatArray:
    """Return the derivatives (n, 3) of the trilinear interpolant along the axes of the grid.

    Between two voxels the interpolant is linear along an axis, so that its slope is the difference
    between the two values there.
    """
    result = np.zeros_like(indices)
    for axis, n in enumerate(volume.size):
        low, _, _ = find_bracket(indices[:, axis], n)
        ends = [indices.copy(), indices.copy()]
        ends[0][:, axis], ends[1][:, axis] = low, low + 1
        # Beyond the centres of the outermost voxels the interpolant is constant
        moves = (indices[:, axis] > 0) & (indices[:, axis] < n - 1)
        slope = _interpolate_trilinearly(volume, ends[1]) - _interpolate_trilinearly(
            volume, ends[0]
        )
        result[:, axis] = np.where(moves, slope, 0)
    return result


def _is_inside_box(volume: Volume, indices: FloatArray) -> BoolArray:
    """Return a mask (n,) of the `indices` (n, 3) of the grid that lie in the volume's box."""
    return np.all((indices >= -0.5) & (indices <= np.array(volume.size) - 0.5), axis=1)
