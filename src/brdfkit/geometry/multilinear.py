"""Multilinear interpolation: the nodes around a point along each axis, and the corners they make.

A bracket is (lower node, upper node, share of the upper). Nodes stand at 0, 1, ... n - 1 of their
axis. The functions that make brackets take NumPy arrays (those for Dr.Jit are in `host/arrays.py`),
`corners` takes brackets of any arrays.
"""

import itertools

import numpy as np


def clamped(x, n):
    """The bracket around `x` among `n` nodes; beyond an end, the end."""
    x = np.clip(x, 0, n - 1)
    lower = np.minimum(x.astype(int), max(n - 2, 0))
    return lower, np.minimum(lower + 1, n - 1), x - lower


def periodic(x, n):
    """The same where node n is node 0."""
    x = np.mod(x, n)
    lower = np.minimum(x.astype(int), n - 1)
    return lower, (lower + 1) % n, x - lower


def corners(brackets):
    """(node along each axis, share) of every corner of the cell around a point; shares add up to 1.

    >>> list(corners([(0, 1, 0.25)]))
    [((0,), 0.75), ((1,), 0.25)]
    """
    for upper in itertools.product((False, True), repeat=len(brackets)):
        nodes, share = [], 1.0
        for (low, high, t), up in zip(brackets, upper, strict=True):
            nodes.append(high if up else low)
            share = share * (t if up else 1 - t)
        yield tuple(nodes), share


def flat(nodes, shape):
    """The index of a corner in an array of `shape`, flattened with its last axis fastest."""
    index = 0
    for node, n in zip(nodes, shape, strict=True):
        index = index * n + node
    return index
