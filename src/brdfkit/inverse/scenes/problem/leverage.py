"""Corrects gradients for leverage, so that standard errors are not too small.

A highlight covers few pixels but determines the parameters nearly alone. The fit then passes close
to these pixels, their residuals are small, and so would be the standard errors. The part of the
gradient from a block of pixels, its score, is therefore divided by the square root of (1 - its
leverage), where the leverage of a block is a matrix [Bell & McCaffrey 2002].
"""

import numpy as np

from brdfkit.core.array_types import AnyArray, BoolArray, FloatArray, IntArray, MitsubaObject

NEGLIGIBLE_TRACE = 0.02  # blocks whose leverage matrix has a smaller trace are not corrected
SMALLEST_REMAINDER = (
    0.05  # for 1 - leverage, as a block that decides alone says nothing about its error
)

Blocks = tuple[IntArray, int]


def number_blocks(scene: MitsubaObject, counted: BoolArray) -> Blocks:
    """Group the pixels of all sensors into square blocks as wide as the camera's filter.

    The filter correlates the noise of pixels within a block. Returns the block number of each pixel
    (pixels,), and how many blocks there are. Blocks without a `counted` pixel get no number; their
    pixels, whose weight is 0, are assigned to block 0.
    """
    parts, count = [], 0
    for sensor in scene.sensors():
        width, height = sensor.film().crop_size()
        side = block_side(sensor)
        rows, columns = np.arange(height) // side, np.arange(width) // side
        across = columns[-1] + 1
        parts.append((count + rows[:, None] * across + columns).ravel())
        count += (rows[-1] + 1) * across
    numbers = np.where(counted, np.concatenate(parts), -1)
    blocks = np.unique(numbers[counted])
    return np.maximum(np.searchsorted(blocks, numbers), 0), len(blocks)


def block_side(sensor: MitsubaObject) -> int:
    """Return the width of a camera's reconstruction filter in pixels, at least 1."""
    return max(1, round(2 * sensor.film().rfilter().radius()))


def sum_by_block(values: AnyArray, blocks: Blocks) -> FloatArray:
    """Return the sums (n, blocks) of `values` (n, pixels) over the blocks of `number_blocks`."""
    index, count = blocks
    return np.array([np.bincount(index, row, count) for row in values])


def correct_for_leverage(scores: FloatArray, jacobian: AnyArray, blocks: Blocks) -> FloatArray:
    """Return the `scores` (n, blocks) corrected for the leverage of each block.

    They are divided by the square root of the matrix 1 - leverage. `jacobian` (n, pixels, channels)
    holds the derivatives of the pixels by the n parameters, times the square roots of the weights.
    """
    n = len(jacobian)
    flat = jacobian.reshape(n, -1).astype(float)
    values, vectors = np.linalg.eigh(flat @ flat.T)
    inside = values > 1e-10 * max(values[-1], 1e-300)
    root = vectors[:, inside] * np.sqrt(values[inside])
    whitening = (vectors[:, inside] / np.sqrt(values[inside])).T
    whitened = np.einsum("ij,jpc->ipc", whitening, jacobian)
    trace = sum_by_block((whitened**2).sum(axis=(0, 2))[None], blocks)[0]
    corrected = scores.copy()
    for block in np.nonzero(trace > NEGLIGIBLE_TRACE)[0]:
        part = whitened[:, blocks[0] == block].reshape(len(whitening), -1)
        leverage, axes = np.linalg.eigh(part @ part.T)
        inverse_root = axes / np.sqrt(np.maximum(1 - leverage, SMALLEST_REMAINDER)) @ axes.T
        corrected[:, block] = root @ (inverse_root @ (whitening @ scores[:, block]))
    return corrected
