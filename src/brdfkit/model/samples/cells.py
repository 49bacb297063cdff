"""Computes what all tables of one size share, such as their cells' directions, and keeps it."""

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray, IntArray
from brdfkit.core.geometry.directions import from_half_difference
from brdfkit.core.jit.padding import make_padded_rows
from brdfkit.model.samples.table import Table


def minimum_cosine(max_angle: float) -> float:
    """Return the cosine that a direction exceeds if its angle is below `max_angle` [degrees].

    A small margin excludes directions whose angle equals `max_angle` but for rounding.
    """
    return math.cos(math.radians(max_angle)) * (1 + 1e-12)


@dataclass(frozen=True, eq=False)
class Cells:
    """The n cells of a table whose directions are near the normal, in C order.

    `numbers` (n,): flat indices of the cells; `wi`, `wo` (n, 3): their directions, with each
    coordinate contiguous in memory; `half_vectors`, `pairs` (n,): increasing indices of the cell of
    the half vector, and of the cell of half vector and theta_d; `extents` (n, 2): amounts of angles
    and of solid angle in the cells. Fits share these arrays, so nobody may change them.
    """

    numbers: IntArray
    wi: FloatArray
    wo: FloatArray
    half_vectors: IntArray
    pairs: IntArray
    extents: FloatArray


@lru_cache(maxsize=1)
def find_cells_within(shape: tuple[int, ...], phi_d_period: float, max_angle: float) -> Cells:
    """Find the `Cells` of a table whose directions are within `max_angle` [degrees] of the normal.

    `shape`: numbers of cells along the axes of a `Table`; `phi_d_period`: range of phi_d [rad].
    """
    table = Table(np.empty((*shape, 0)), phi_d_period)
    first, *others = table.centres
    parts, size = [], math.prod(map(len, others))
    for number, centre in enumerate(first):  # one slab of the table at a time, to save memory
        *phi_h, theta_h, theta_d, phi_d = np.meshgrid([centre], *others, indexing="ij")
        pair = from_half_difference(theta_h, theta_d, phi_d, *phi_h)
        wi, wo = (w.reshape(-1, 3) for w in pair)
        cos_min = minimum_cosine(max_angle)
        rows = np.flatnonzero((wi[:, 2] > cos_min) & (wo[:, 2] > cos_min))
        parts.append(((number * size + rows).astype(np.int32), wi[rows], wo[rows]))
    numbers, wi, wo = (np.concatenate(part) for part in zip(*parts, strict=True))
    n_h, n_d, n_p = shape[-3:]
    pairs = numbers // n_p
    extents = copy_columns(table.extents.reshape(-1, 2), pairs % (n_h * n_d))
    return Cells(numbers, copy_columns(wi), copy_columns(wo), pairs // n_d, pairs, extents)


def copy_columns(array: AnyArray, rows: Any = None) -> AnyArray:
    """Copy an array (n, k), or its `rows`, with each column contiguous, as Dr.Jit needs it."""
    taken = [values if rows is None else values[rows] for values in array.T]
    columns = make_padded_rows(len(taken), len(taken[0]))
    for column, values in zip(columns, taken, strict=True):
        column[:] = values
    return columns.T
