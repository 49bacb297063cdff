"""Cuts a picture into blocks of nearly constant value, by a tree of axis-aligned cuts.

The block whose criterion is largest is cut next, at the place where the squared errors of its two
parts about their means have the smallest sum. Sums over blocks come from summed-area tables. All
blocks that are among the next to be cut are cut at once, which ends with the same tree.

[Ergun 2015, Algorithm 2, eqs. 6.1, 6.2]
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np


@dataclass(frozen=True)
class Tree:
    """Nodes: `boxes` (n, 4) of columns x0 ≤ x < x1 and rows y0 ≤ y < y1, and their parts.

    `left` (n,) is the index of a node's left or upper part, behind which the other part stands; -1
    for a block, which is not cut. Node 0 is the whole picture.
    """

    boxes: np.ndarray
    left: np.ndarray

    @property
    def blocks(self):
        """The boxes (n, 4) of the blocks, which cover the picture once."""
        return self.boxes[self.left < 0]


def build(values, count, criterion="relative"):
    """The `Tree` of at most `count` blocks of `values` (height, width) ≥ 0.

    A block of constant value is not cut, so that there may be fewer than `count`. `criterion`: a
    name in `CRITERIA`.

    >>> build(np.array([[0.0, 0.0, 1.0]]), 2).blocks.tolist()
    [[0, 2, 0, 1], [2, 3, 0, 1]]
    """
    return build_by(Sums(values), count, criterion)


def build_by(sums, count, criterion="relative"):
    """`build` of values whose `Sums` are at hand."""
    height, width = sums.values.shape
    error = CRITERIA[criterion]
    boxes, left = np.array([[0, width, 0, height]]), np.array([-1])
    keys = error(sums, boxes)
    while True:
        # In the end, the nodes of the `count` - 1 largest keys are cut; keys that more nodes reach
        # already are large enough. Half of those above, so that few are cut in vain
        enough = np.partition(keys, -count + 1)[-count + 1] if 1 < count <= len(keys) else 0
        uncut = np.flatnonzero((left < 0) & (keys > 0) & (keys >= enough))
        if len(uncut) == 0 or count == 1:
            return _of_nodes_cut(boxes, left, np.argsort(-keys, kind="stable")[: count - 1])
        uncut = uncut[np.argsort(-keys[uncut], kind="stable")[: len(uncut) // 2 + 1]]
        left[uncut] = len(boxes) + 2 * np.arange(len(uncut))
        parts = _cut(sums, boxes[uncut])
        # A part cannot be cut before the whole, even if its criterion is larger
        keys = np.append(keys, np.minimum(error(sums, parts), np.repeat(keys[uncut], 2)))
        boxes, left = np.append(boxes, parts, axis=0), np.append(left, np.full(len(parts), -1))


class Sums:
    """Sums of `values` (height, width), and of their squares, over any blocks."""

    def __init__(self, values):
        self.values = values
        self.table, self.squares = _summed_area_table(values), _summed_area_table(values**2)
        self.rounding = 1e-14 * self.squares[-1, -1]  # of sums of squares

    def of(self, boxes):
        """Numbers of pixels (n,), sums of values and sums of squares over `boxes` (n, 4)."""
        x0, x1, y0, y1 = boxes.T
        return (x1 - x0) * (y1 - y0), self.of_values(boxes), _sums(self.squares, boxes)

    def of_values(self, boxes):
        """Sums of values (n,) over `boxes` (n, 4)."""
        return _sums(self.table, boxes)


def block_sums(values, boxes):
    """The sums (n,) of `values` (height, width) over each of the `boxes` (n, 4)."""
    return _sums(_summed_area_table(values), boxes)


# What a block's error is: each takes `Sums` and boxes (n, 4), and returns (n,)


def squared_error(sums, boxes):
    """Σ (value - mean)²."""
    n, sum_, squares = sums.of(boxes)
    error = squares - sum_**2 / n
    return np.where((n > 1) & (error > sums.rounding), error, 0)


def relative_squared_error(sums, boxes):
    """Σ (value - mean)² / mean: what the block adds to the variance of a sample's weight.

    The variance, times the square of the picture's sum, is Σ value² / density less that square;
    with the density of a block in proportion to its mean, it is the sum of this error over blocks.
    """
    n, sum_, _ = sums.of(boxes)
    return squared_error(sums, boxes) * n / np.maximum(sum_, 1e-300)


def variance(sums, boxes):
    """Σ (value - mean)² / (n - 1)."""
    n = sums.of(boxes)[0]
    return squared_error(sums, boxes) / np.maximum(n - 1, 1)


def value_range(sums, boxes):
    """The largest value less the smallest."""
    cut_out = (sums.values[y0:y1, x0:x1] for x0, x1, y0, y1 in boxes.tolist())
    return np.array([block.max() - block.min() for block in cut_out])


CRITERIA = {
    "relative": relative_squared_error,
    "sse": squared_error,
    "variance": variance,
    "range": value_range,
}


def _summed_area_table(values):
    """(height + 1, width + 1): entry (y, x) is the sum over the rows below y, columns below x."""
    table = np.zeros((values.shape[0] + 1, values.shape[1] + 1))
    np.cumsum(values, axis=1, out=table[1:, 1:])
    for above, row in pairwise(table):  # twice as fast as a sum along columns
        row += above
    return table


def _sums(table, boxes):
    x0, x1, y0, y1 = boxes.T
    return table[y1, x1] - table[y0, x1] - table[y1, x0] + table[y0, x0]


def _cut(sums, boxes):
    """The two parts (2n, 4) of each of the `boxes` (n, 4), which hold more than one pixel."""
    x, across = _best_column(sums.table, boxes)
    y, down = _best_column(sums.table.T, boxes[:, [2, 3, 0, 1]])
    vertical = across >= down
    first, second = boxes.copy(), boxes.copy()
    first[vertical, 1] = second[vertical, 0] = x[vertical]
    first[~vertical, 3] = second[~vertical, 2] = y[~vertical]
    return np.stack([first, second], axis=1).reshape(-1, 4)


def _best_column(table, boxes):
    """The column before which each box (n, 4) is best cut, and eq. 6.2 there, -1 if too narrow.

    Eq. 6.2, Σ (sum of a part)² / (its number of pixels), is largest where the squared error is
    smallest.
    """
    x0, x1, y0, y1 = boxes.T
    cuts = x1 - x0 - 1
    start, whole = np.cumsum(cuts) - cuts, _sums(table, boxes)
    # The columns inside the boxes, one box behind the other; to the left of each, a part of n
    n = np.arange(1, cuts.sum() + 1) - np.repeat(start, cuts)
    x, top, bottom = np.repeat(x0, cuts) + n, np.repeat(y0, cuts), np.repeat(y1, cuts)
    left = table[bottom, x] - table[top, x] - np.repeat(table[y1, x0] - table[y0, x0], cuts)
    right = np.repeat(whole, cuts) - left
    score = left**2 / n + right**2 / (np.repeat(x1 - x0, cuts) - n)

    best, at = np.full(len(boxes), -1.0), x0.copy()
    wide = cuts > 0
    if wide.any():
        best[wide] = np.maximum.reduceat(score, start[wide])
    hits = np.flatnonzero(score == np.repeat(best, cuts))[::-1]  # the first is written last
    box = np.searchsorted(start[wide], hits, side="right") - 1
    at[np.flatnonzero(wide)[box]] += n[hits]
    return at, best / (y1 - y0)


def _of_nodes_cut(boxes, left, cut):
    """The `Tree` in which only the nodes `cut` are cut, of nodes of which more were."""
    cut = np.sort(cut[left[cut] >= 0])
    kept = np.concatenate([[0], (left[cut][:, None] + [0, 1]).ravel()])
    number = np.zeros(len(boxes), int)
    number[kept] = np.arange(len(kept))
    new = np.full(len(kept), -1)
    new[number[cut]] = number[left[cut]]
    return Tree(boxes[kept], new)
