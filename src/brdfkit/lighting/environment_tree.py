"""Cuts a picture into blocks of nearly constant value, by a tree of axis-aligned cuts.

The block with the largest sum of squared errors about its mean is cut next, at the place where its
two parts have the smallest sum together. Sums over blocks come from summed-area tables, so that a
cut takes time in proportion to the block's width plus height.

[Ergun 2015, Algorithm 2, eqs. 6.1, 6.2]
"""

import heapq

import numpy as np


def blocks(values, count):
    """At most `count` blocks (n, 4) of `values` (height, width) ≥ 0, each (x0, x1, y0, y1).

    A block holds the columns x0 ≤ x < x1 and the rows y0 ≤ y < y1; together they cover the picture
    once. A block of constant value is not cut, so that there may be fewer than `count`.

    >>> blocks(np.array([[0.0, 0.0, 1.0]]), 2).tolist()
    [[0, 2, 0, 1], [2, 3, 0, 1]]
    """
    height, width = values.shape
    table, squares = _summed_area_table(values), _summed_area_table(values**2)
    rounding = 1e-12 * squares[-1, -1]  # a block with no larger error is of constant value
    whole = (0, width, 0, height)
    waiting = [(-_squared_error(table, squares, whole), whole)]  # a heap, the largest error first
    while len(waiting) < count and -waiting[0][0] > rounding:
        _, block = heapq.heappop(waiting)
        for part in _cut(table, block):
            heapq.heappush(waiting, (-_squared_error(table, squares, part), part))
    return np.array(sorted(block for _, block in waiting))


def block_sums(values, blocks):
    """The sums (n,) of `values` (height, width) over each of the `blocks` (n, 4)."""
    return _block_sum(_summed_area_table(values), blocks.T)


def _summed_area_table(values):
    """(height + 1, width + 1): entry (y, x) is the sum over the rows below y, columns below x."""
    return np.pad(values, ((1, 0), (1, 0))).cumsum(axis=0).cumsum(axis=1)


def _block_sum(table, block):
    """The sum over a block (x0, x1, y0, y1), whose entries may be arrays."""
    x0, x1, y0, y1 = block
    return table[y1, x1] - table[y0, x1] - table[y1, x0] + table[y0, x0]


def _squared_error(table, squares, block):
    """The sum of squared errors of a block about its mean."""
    x0, x1, y0, y1 = block
    return _block_sum(squares, block) - _block_sum(table, block) ** 2 / ((x1 - x0) * (y1 - y0))


def _cut(table, block):
    """The two parts of a block that holds more than one pixel."""
    x0, x1, y0, y1 = block
    whole = _block_sum(table, block)
    x, y = np.arange(x0 + 1, x1), np.arange(y0 + 1, y1)
    left, above = _block_sum(table, (x0, x, y0, y1)), _block_sum(table, (x0, x1, y0, y))
    # Eq. 6.2, Σ (sum of a part)² / (its number of pixels), for every cut between two columns
    # (across) and between two rows (down): where it is largest, the squared error is smallest
    across = (left**2 / (x - x0) + (whole - left) ** 2 / (x1 - x)) / (y1 - y0)
    down = (above**2 / (y - y0) + (whole - above) ** 2 / (y1 - y)) / (x1 - x0)
    if across.max(initial=-1) >= down.max(initial=-1):
        at = int(x[across.argmax()])
        return (x0, at, y0, y1), (at, x1, y0, y1)
    at = int(y[down.argmax()])
    return (x0, x1, y0, at), (x0, x1, at, y1)
