"""The directions of a table's cells: equal for all tables of one size, and so computed once."""

import math
from functools import lru_cache

import numpy as np

from brdfkit.core.geometry.directions import from_half_difference
from brdfkit.core.jit.padding import make_padded_rows


def minimum_cosine(max_angle):
    """The cosine that a direction's z exceeds where its angle to the normal is below `max_angle`
    [degrees]."""
    return math.cos(math.radians(max_angle)) * (1 + 1e-12)


@lru_cache(maxsize=1)
def find_directions_within(axes, max_angle):
    """(cells, wi, wo): the numbers (n,), in C order, of the cells with both angles below
    `max_angle` [degrees], and their directions (n, 3), each coordinate contiguous.

    `axes`: the centres along ([phi_h,] theta_h, theta_d, phi_d) [rad], tuples.
    """
    first, *others = axes
    parts, size = [], math.prod(map(len, others))
    for number, centre in enumerate(first):  # a slab at a time: little memory
        *phi_h, theta_h, theta_d, phi_d = np.meshgrid([centre], *others, indexing="ij")
        pair = from_half_difference(theta_h, theta_d, phi_d, *phi_h)
        wi, wo = (w.reshape(-1, 3) for w in pair)
        cos_min = minimum_cosine(max_angle)
        rows = np.flatnonzero((wi[:, 2] > cos_min) & (wo[:, 2] > cos_min))
        parts.append(((number * size + rows).astype(np.int32), wi[rows], wo[rows]))
    cells, wi, wo = (np.concatenate(part) for part in zip(*parts, strict=True))
    return cells, copy_columns(wi), copy_columns(wo)


def copy_columns(array, rows=None):
    """An array (n, k), or its `rows`, whose columns are contiguous, and as Dr.Jit reads them."""
    taken = [values if rows is None else values[rows] for values in array.T]
    columns = make_padded_rows(len(taken), len(taken[0]))
    for column, values in zip(columns, taken, strict=True):
        column[:] = values
    return columns.T
