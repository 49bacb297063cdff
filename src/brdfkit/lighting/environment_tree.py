"""A picture cut into blocks of nearly constant value, by a tree of axis-aligned cuts.

The block with the largest sum of squared errors about its mean is cut next, where its two parts
have the least together. Sums over blocks come from summed-area tables, so that a cut costs as many
steps as the block is wide and high.

[Ergun 2015, Algorithm 2, eqs. 6.1, 6.2]
"""

import heapq

import numpy as np


def blocks(values, count):
    """At most `count` blocks (n, 4) of `values` (height, width) ≥ 0: x from, x to, y from, y to.

    They cover the picture once; a block of one value is not cut, so that there may be fewer.

    >>> blocks(np.array([[0.0, 0.0, 1.0]]), 2).tolist()
    [[0, 2, 0, 1], [2, 3, 0, 1]]
    """
    height, width = values.shape
    sums, squares = _summed(values), _summed(values**2)
    # Rounding of the tables: a block whose error is not above it is even
    rounding = 1e-12 * squares[-1, -1]
    waiting = [(-_error(sums, squares, whole), whole) for whole in [(0, width, 0, height)]]
    while len(waiting) < count and -waiting[0][0] > rounding:
        _, block = heapq.heappop(waiting)
        for part in _cut(sums, block):
            heapq.heappush(waiting, (-_error(sums, squares, part), part))
    return np.array(sorted(block for _, block in waiting))


def sums(values, found):
    """The sum (n,) of `values` (height, width) over each of the blocks `found` (n, 4)."""
    return _over(_summed(values), found.T)


def _summed(values):
    """Sums of all values above and to the left of each corner (height + 1, width + 1)."""
    return np.pad(values, ((1, 0), (1, 0))).cumsum(axis=0).cumsum(axis=1)


def _over(table, block):
    x0, x1, y0, y1 = block
    return table[y1, x1] - table[y0, x1] - table[y1, x0] + table[y0, x0]


def _error(sums, squares, block):
    """Sum of squared errors of a block about its mean."""
    x0, x1, y0, y1 = block
    return _over(squares, block) - _over(sums, block) ** 2 / ((x1 - x0) * (y1 - y0))


def _cut(sums, block):
    """The two parts of a block of more than one value."""
    x0, x1, y0, y1 = block
    whole = _over(sums, block)
    x, y = np.arange(x0 + 1, x1), np.arange(y0 + 1, y1)
    left, above = _over(sums, (x0, x, y0, y1)), _over(sums, (x0, x1, y0, y))
    # Eq. 6.2 over the parts' numbers of values; the common factor of either axis counts as well
    across = (left**2 / (x - x0) + (whole - left) ** 2 / (x1 - x)) / (y1 - y0)
    down = (above**2 / (y - y0) + (whole - above) ** 2 / (y1 - y)) / (x1 - x0)
    if across.max(initial=-1) >= down.max(initial=-1):
        at = int(x[across.argmax()])
        return (x0, at, y0, y1), (at, x1, y0, y1)
    at = int(y[down.argmax()])
    return (x0, x1, y0, at), (x0, x1, at, y1)
