"""What single parts of a picture decide: a highlight of few pixels pulls the numbers to itself.

Where it does, its residuals are small, and standard errors by them too. So a part's score is
divided by the root of one less its leverage, a matrix here [Bell & McCaffrey 2002].
"""

import numpy as np

SLIGHT = 0.02  # a leverage, of a trace, that changes nothing
LEAST = 0.05  # of one less a leverage: more cannot be told from a part that decides alone


def number_blocks(scene, seen):
    """(the number of the block (pixels,) of each pixel of all sensors; how many there are).

    Blocks are as wide as the camera's filter, which ties the noise of neighbours together. Those
    without a pixel that is `seen` are none; their pixels, which add 0, go to the first.
    """
    found, count = [], 0
    for sensor in scene.sensors():
        width, height = sensor.film().crop_size()
        side = block_side(sensor)
        rows, columns = np.arange(height) // side, np.arange(width) // side
        across = columns[-1] + 1
        found.append((count + rows[:, None] * across + columns).ravel())
        count += (rows[-1] + 1) * across
    found = np.where(seen, np.concatenate(found), -1)
    blocks = np.unique(found[seen])
    return np.maximum(np.searchsorted(blocks, found), 0), len(blocks)


def block_side(sensor):
    """How many pixels wide the filter of a camera is, at least 1."""
    return max(1, round(2 * sensor.film().rfilter().radius()))


def sum_by_block(values, blocks):
    """Sums of `values` (n, pixels) over the `blocks` of `number_blocks`: (n, blocks)."""
    index, count = blocks
    return np.array([np.bincount(index, row, count) for row in values])


def without_leverage(scores, jacobian, blocks):
    """The `scores` (n, blocks), as large as those of residuals that no number was fitted to.

    jacobian : (n, pixels, channels), times the roots of the weights.
    """
    n = len(jacobian)
    flat = jacobian.reshape(n, -1).astype(float)
    values, vectors = np.linalg.eigh(flat @ flat.T)
    inside = values > 1e-10 * max(values[-1], 1e-300)
    root = vectors[:, inside] * np.sqrt(values[inside])
    white = (vectors[:, inside] / np.sqrt(values[inside])).T
    share = np.einsum("ij,jpc->ipc", white, jacobian)
    trace = sum_by_block([(share**2).sum(axis=(0, 2))], blocks)[0]
    found = scores.copy()
    for block in np.nonzero(trace > SLIGHT)[0]:
        part = share[:, blocks[0] == block].reshape(len(white), -1)
        leverage, turn = np.linalg.eigh(part @ part.T)
        lifted = turn / np.sqrt(np.maximum(1 - leverage, LEAST)) @ turn.T
        found[:, block] = root @ (lifted @ (white @ scores[:, block]))
    return found
