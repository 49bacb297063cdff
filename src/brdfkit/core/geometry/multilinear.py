"""Multilinear interpolation: the nodes around a point on each axis, the corners of its cell.

A bracket is (lower node, upper node, weight of the upper node) on one axis, whose nodes lie at
0, 1, ... n - 1. `find_bracket` and `find_periodic_bracket` take NumPy arrays; the functions of the
same name in `mitsuba_bridge/arrays.py` take Dr.Jit's arrays, and `list_corners` takes both.
"""

import itertools
from collections.abc import Iterator, Sequence
from typing import Any, TypeAlias

import numpy as np

from brdfkit.core.array_types import AnyArray

Bracket: TypeAlias = tuple[Any, Any, Any]


def find_bracket(x: AnyArray, n: int) -> Bracket:
    """Return the lower and upper node around `x` among 0 ... n - 1, and the upper one's weight."""
    x = np.clip(x, 0, n - 1)
    lower = np.minimum(x.astype(int), max(n - 2, 0))
    return lower, np.minimum(lower + 1, n - 1), x - lower


def find_periodic_bracket(x: AnyArray, n: int) -> Bracket:
    """Return the lower and upper node around `x` (node n is node 0), and the upper one's weight."""
    x = np.mod(x, n)
    lower = np.minimum(x.astype(int), n - 1)
    return lower, (lower + 1) % n, x - lower


def list_corners(brackets: Sequence[Bracket]) -> Iterator[tuple[tuple[Any, ...], Any]]:
    """Yield (node on each axis, weight) for every corner of the cell around a point.

    `brackets` has (lower node, upper node, weight of the upper) for each axis. The weights of all
    corners add up to 1.

    >>> list(list_corners([(0, 1, 0.25)]))
    [((0,), 0.75), ((1,), 0.25)]
    """
    for upper in itertools.product((False, True), repeat=len(brackets)):
        nodes, weight = [], 1.0
        for (low, high, t), up in zip(brackets, upper, strict=True):
            nodes.append(high if up else low)
            weight = weight * (t if up else 1 - t)
        yield tuple(nodes), weight


def to_flat_index(nodes: Sequence[Any], shape: Sequence[int]) -> Any:
    """Return the index in a flattened array of `shape` of the element at `nodes` on the axes."""
    index = 0
    for node, n in zip(nodes, shape, strict=True):
        index = index * n + node
    return index
