"""Corrects gradients for the leverage of pixels, so that standard errors are not too small.

A highlight covers few pixels but determines the parameters nearly alone. The fit then passes close
to these pixels, so their residuals are small, and standard errors that follow from residuals would
be too small. The part of the gradient that comes from a block of pixels, its score, is therefore
divided by the square root of 1 - leverage, where the leverage of a block is a matrix
[Bell & McCaffrey 2002].
"""

import numpy as np

from brdfkit.core.array_types import AnyArray, BoolArray, FloatArray, IntArray, MitsubaObject

NEGLIGIBLE_TRACE = 0.02  # a block's score is corrected if its leverage matrix has a larger trace
# Lower limit of 1 - leverage, by whose root scores are divided; it is 0 for a block that decides
# alone
SMALLEST_REMAINDER = 0.05

Blocks = tuple[IntArray, int]  # the block of each pixel (pixels,), and the number of blocks


def group_pixels_by_block(sensors: list[MitsubaObject], counted: BoolArray) -> Blocks:
    """Group the pixels of all pictures into square blocks as wide as the camera's filter.

    `sensors` holds the camera of each picture, whose filter correlates the noise of pixels within a
    block. Returns the block of each pixel (pixels,), and the number of blocks. Only blocks with a
    `counted` pixel are numbered; pixels of other blocks, whose weight is 0, are assigned to block
    0.
    """
    parts, count = [], 0
    for sensor in sensors:
        width, height = sensor.film().crop_size()
        side = find_block_side(sensor)
        rows, columns = np.arange(height) // side, np.arange(width) // side
        across = columns[-1] + 1
        parts.append((count + rows[:, None] * across + columns).ravel())
        count += (rows[-1] + 1) * across
    numbers = np.where(counted, np.concatenate(parts), -1)
    blocks = np.unique(numbers[counted])
    return np.maximum(np.searchsorted(blocks, numbers), 0), len(blocks)


def find_block_side(sensor: MitsubaObject) -> int:
    """Return the side of blocks with independent noise: a camera's filter width in pixels."""
    return max(1, round(2 * sensor.film().rfilter().radius()))


def sum_by_block(values: AnyArray, blocks: Blocks) -> FloatArray:
    """Return the sums (n, blocks) of `values` (n, pixels) over the blocks of pixels."""
    index, count = blocks
    return np.array([np.bincount(index, row, count) for row in values])


def correct_for_leverage(scores: FloatArray, jacobian: AnyArray, blocks: Blocks) -> FloatArray:
    """Return the `scores` (n, blocks), divided by the square root of the matrix 1 - leverage.

    A score is a block's part of the gradient with respect to the n parameters. `jacobian` (n,
    pixels, channels) holds the derivatives of the pixels with respect to the parameters, times the
    square roots of the weights.
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
