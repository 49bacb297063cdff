"""A tree of axis-aligned cuts that divides a picture into blocks of nearly constant value.

The block with the largest error, by some criterion, is cut next, at the column or row that
minimises the squared errors of its two parts about their means. Summed-area tables give the sums
over blocks. For speed, many blocks are cut at once, in a way that gives the same tree.

A box is (x0, x1, y0, y1): columns x0 ≤ x < x1 and rows y0 ≤ y < y1.

[Ergun 2015, Algorithm 2, eqs. 6.1, 6.2]
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray, IntArray


@dataclass(frozen=True)
class Tree:
    """A binary tree of boxes in a picture, whose leaves are the blocks.

    `boxes` (n, 4) are the boxes of all nodes; node 0 is the whole picture. `left` (n,) is the index
    of a node's left or upper part, which the other part follows, and -1 for a block.
    """

    boxes: IntArray
    left: IntArray

    @property
    def blocks(self) -> IntArray:
        """The boxes (blocks, 4) of the blocks, which cover the picture without overlaps."""
        return self.boxes[self.left < 0]


def build_tree(values: FloatArray, count: int, criterion: str = "relative") -> Tree:
    """Cut `values` (height, width) ≥ 0 into at most `count` blocks.

    There may be fewer, since blocks of constant value are not cut. `criterion` names the error in
    CRITERIA by which the next block to cut is chosen.

    >>> build_tree(np.array([[0.0, 0.0, 1.0]]), 2).blocks.tolist()
    [[0, 2, 0, 1], [2, 3, 0, 1]]
    """
    return build_tree_from_sums(Sums(values), count, criterion)


def build_tree_from_sums(sums: Sums, count: int, criterion: str = "relative") -> Tree:
    """Cut a picture into at most `count` blocks like `build_tree`, by the `Sums` of its values."""
    height, width = sums.values.shape
    error = CRITERIA[criterion]
    boxes, left = np.array([[0, width, 0, height]]), np.array([-1])
    keys = error(sums, boxes)
    while True:
        # `keys` holds the errors of the nodes. The finished tree cuts the `count` - 1 nodes with
        # the largest keys. A node that is not among them now never will be. Only half of those that
        # are among them are cut at once, lest many of the cuts be in vain
        threshold = np.partition(keys, -count + 1)[-count + 1] if 1 < count <= len(keys) else 0
        uncut = np.flatnonzero((left < 0) & (keys > 0) & (keys >= threshold))
        if len(uncut) == 0 or count == 1:
            return _keep_cut_nodes(boxes, left, np.argsort(-keys, kind="stable")[: count - 1])
        uncut = uncut[np.argsort(-keys[uncut], kind="stable")[: len(uncut) // 2 + 1]]
        left[uncut] = len(boxes) + 2 * np.arange(len(uncut))
        parts = _cut_boxes(sums, boxes[uncut])
        # A part's key is limited to that of the whole, since it cannot be cut before the whole
        keys = np.append(keys, np.minimum(error(sums, parts), np.repeat(keys[uncut], 2)))
        boxes, left = np.append(boxes, parts, axis=0), np.append(left, np.full(len(parts), -1))


class Sums:
    """Sums of a picture's `values` (height, width), and of their squares, over boxes."""

    def __init__(self, values: FloatArray) -> None:
        self.values = values
        self.table, self.squares = summed_area_table(values), summed_area_table(values**2)
        self.rounding = 1e-14 * self.squares[-1, -1]  # largest rounding error of sums of squares

    def sum_moments(self, boxes: IntArray) -> tuple[IntArray, FloatArray, FloatArray]:
        """Return the numbers of pixels in `boxes` (n, 4), the sums of values, and of squares."""
        x0, x1, y0, y1 = boxes.T
        return (x1 - x0) * (y1 - y0), self.sum_values(boxes), _sum_boxes(self.squares, boxes)

    def sum_values(self, boxes: IntArray) -> FloatArray:
        """Return the sums (n,) of the picture's values over `boxes` (n, 4)."""
        return _sum_boxes(self.table, boxes)


def block_sums(values: FloatArray, boxes: IntArray) -> FloatArray:
    """Return the sums (n,) of `values` (height, width) over each of the `boxes` (n, 4)."""
    return _sum_boxes(summed_area_table(values), boxes)


def squared_error(sums: Sums, boxes: IntArray) -> FloatArray:
    """Return the squared error Σ (value - mean)² (n,) of the values in each box (n, 4)."""
    n, sum_, squares = sums.sum_moments(boxes)
    error = squares - sum_**2 / n
    return np.where((n > 1) & (error > sums.rounding), error, 0)


def relative_squared_error(sums: Sums, boxes: IntArray) -> FloatArray:
    """Return Σ (value - mean)² / mean (n,) of each box (n, 4).

    It is proportional to the box's contribution to the variance of samples' weights, if samples are
    drawn in proportion to the blocks' means.
    """
    n, sum_, _ = sums.sum_moments(boxes)
    return squared_error(sums, boxes) * n / np.maximum(sum_, 1e-300)


def variance(sums: Sums, boxes: IntArray) -> FloatArray:
    """Return the variance Σ (value - mean)² / (pixels - 1) (n,) of values in each box (n, 4)."""
    n = sums.sum_moments(boxes)[0]
    return squared_error(sums, boxes) / np.maximum(n - 1, 1)


def value_range(sums: Sums, boxes: IntArray) -> FloatArray:
    """Return the difference (n,) of the largest and the smallest value in each box (n, 4)."""
    cut_out = (sums.values[y0:y1, x0:x1] for x0, x1, y0, y1 in boxes.tolist())
    return np.array([block.max() - block.min() for block in cut_out])


CRITERIA = {  # Error measures of blocks by name; the block with the largest error is cut next
    "relative": relative_squared_error,
    "sse": squared_error,
    "variance": variance,
    "range": value_range,
}


def summed_area_table(values: AnyArray) -> FloatArray:
    """Return a table (height + 1, width + 1): entry (y, x) sums all rows < y and columns < x."""
    table = np.zeros((values.shape[0] + 1, values.shape[1] + 1))
    np.cumsum(values, axis=1, out=table[1:, 1:])
    for above, row in pairwise(table):  # this loop is twice as fast as np.cumsum along columns
        row += above
    return table


def _sum_boxes(table: FloatArray, boxes: IntArray) -> FloatArray:
    """Return the sums (n,) of values over `boxes` (n, 4), from their summed-area table."""
    x0, x1, y0, y1 = boxes.T
    return table[y1, x1] - table[y0, x1] - table[y1, x0] + table[y0, x0]


def _cut_boxes(sums: Sums, boxes: IntArray) -> IntArray:
    """Cut each of the `boxes` (n, 4), of two pixels or more, into its two best parts (2n, 4)."""
    x, across = _find_best_column(sums.table, boxes)
    y, down = _find_best_column(sums.table.T, boxes[:, [2, 3, 0, 1]])
    vertical = across >= down
    first, second = boxes.copy(), boxes.copy()
    first[vertical, 1] = second[vertical, 0] = x[vertical]
    first[~vertical, 3] = second[~vertical, 2] = y[~vertical]
    return np.stack([first, second], axis=1).reshape(-1, 4)


def _find_best_column(table: FloatArray, boxes: IntArray) -> tuple[IntArray, FloatArray]:
    """Return the column (n,) before which each box is best cut, and the cut's score (n,).

    The score is Σ (sum of a part)² / (its number of pixels), which is largest where the parts'
    squared error is smallest. A box of one column, which cannot be cut, has the score -1.
    [Ergun 2015, eq. 6.2]
    """
    x0, x1, y0, y1 = boxes.T
    cuts = x1 - x0 - 1
    start, whole = np.cumsum(cuts) - cuts, _sum_boxes(table, boxes)
    # Score all possible cuts of all boxes at once; n columns of a box lie to the left of a cut
    n = np.arange(1, cuts.sum() + 1) - np.repeat(start, cuts)
    x, top, bottom = np.repeat(x0, cuts) + n, np.repeat(y0, cuts), np.repeat(y1, cuts)
    left = table[bottom, x] - table[top, x] - np.repeat(table[y1, x0] - table[y0, x0], cuts)
    right = np.repeat(whole, cuts) - left
    score = left**2 / n + right**2 / (np.repeat(x1 - x0, cuts) - n)

    best, at = np.full(len(boxes), -1.0), x0.copy()
    wide = cuts > 0
    if wide.any():
        best[wide] = np.maximum.reduceat(score, start[wide])
    # Reversed, as of several assignments the last one counts: the first of equal scores is kept
    hits = np.flatnonzero(score == np.repeat(best, cuts))[::-1]
    box = np.searchsorted(start[wide], hits, side="right") - 1
    at[np.flatnonzero(wide)[box]] += n[hits]
    return at, best / (y1 - y0)


def _keep_cut_nodes(boxes: IntArray, left: IntArray, cut: IntArray) -> Tree:
    """Return the `Tree` in which only the nodes with the indices `cut` are cut, without the rest.

    `boxes` and `left` are those of the larger tree.
    """
    cut = np.sort(cut[left[cut] >= 0])
    kept = np.concatenate([[0], (left[cut][:, None] + [0, 1]).ravel()])
    number = np.zeros(len(boxes), int)
    number[kept] = np.arange(len(kept))
    new = np.full(len(kept), -1)
    new[number[cut]] = number[left[cut]]
    return Tree(boxes[kept], new)
