"""Computes the directions of a table's cells, and keeps them for further tables of this size."""

import math
from functools import lru_cache
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray, IntArray
from brdfkit.core.geometry.directions import from_half_difference
from brdfkit.core.jit.padding import make_padded_rows


def minimum_cosine(max_angle: float) -> float:
    """Return the cosine that a direction exceeds if its angle is below `max_angle` [degrees].

    A small margin excludes directions whose angle equals `max_angle` but for rounding.
    """
    return math.cos(math.radians(max_angle)) * (1 + 1e-12)


@lru_cache(maxsize=1)
def find_directions_within(
    axes: tuple[tuple[float, ...], ...], max_angle: float
) -> tuple[IntArray, FloatArray, FloatArray]:
    """Find the cells of a table whose directions are within `max_angle` [degrees] of the normal.

    `axes` are the centres of the cells along ([phi_h,] theta_h, theta_d, phi_d) [rad]. Returns the
    flat indices of the cells (n,) in C order, and their directions wi and wo (n, 3), with each
    coordinate contiguous in memory.
    """
    first, *others = axes
    parts, size = [], math.prod(map(len, others))
    for number, centre in enumerate(first):  # one slab of the table at a time, to save memory
        *phi_h, theta_h, theta_d, phi_d = np.meshgrid([centre], *others, indexing="ij")
        pair = from_half_difference(theta_h, theta_d, phi_d, *phi_h)
        wi, wo = (w.reshape(-1, 3) for w in pair)
        cos_min = minimum_cosine(max_angle)
        rows = np.flatnonzero((wi[:, 2] > cos_min) & (wo[:, 2] > cos_min))
        parts.append(((number * size + rows).astype(np.int32), wi[rows], wo[rows]))
    cells, wi, wo = (np.concatenate(part) for part in zip(*parts, strict=True))
    return cells, copy_columns(wi), copy_columns(wo)


def copy_columns(array: AnyArray, rows: Any = None) -> AnyArray:
    """Copy an array (n, k), or its `rows`, with each column contiguous, as Dr.Jit needs it."""
    taken = [values if rows is None else values[rows] for values in array.T]
    columns = make_padded_rows(len(taken), len(taken[0]))
    for column, values in zip(columns, taken, strict=True):
        column[:] = values
    return columns.T
