"""The cells in which a prior describes materials, and the interpolation of logarithms between them.

The cells are those of a `Table` with `SHAPE` cells, of which an isotropic, reciprocal material
without handedness needs only half: φd and π - φd have the same value. A prior holds in every cell
the logarithm y of the BRDF f, times cosines, relative to a reference material [Nielsen et al.
2015]:

    y = ln((f c + e) / (f_ref c + e)),    c = max(cosθi cosθo, 0.05),    e = 10⁻³ sr⁻¹
"""

from dataclasses import dataclass
from functools import cache
from math import pi, radians

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray, IntArray
from brdfkit.core.geometry.directions import to_half_difference
from brdfkit.core.geometry.multilinear import (
    find_bracket,
    find_periodic_bracket,
    list_corners,
    to_flat_index,
)
from brdfkit.materials.measured.evidence import LEAST_COSINE, OFFSET
from brdfkit.model.samples import Table

SHAPE = (90, 30, 32)  # numbers of cells along theta_h, theta_d and phi_d, of which half are kept
KEPT_SHAPE = (90, 30, 16)
CELLS = 90 * 30 * 16
LARGEST_ANGLE = radians(85)  # values nearer to the horizon are those of the last cell before it


@dataclass(frozen=True)
class PriorCells:
    """The directions of all kept cells.

    `wi`, `wo` (CELLS, 3): directions at which a material is evaluated for a cell; in cells near or
    below the horizon they are those of the next cell above it. `cosine` (CELLS,): c of the cells.
    `own` (CELLS,): False in the cells that have another cell's directions. `theta_i`, `theta_o`
    (CELLS,): angles to the normal of the cells' centres [rad], above π/2 below the surface.
    """

    wi: FloatArray
    wo: FloatArray
    cosine: FloatArray
    own: AnyArray
    theta_i: FloatArray
    theta_o: FloatArray


@cache
def get_cells() -> PriorCells:
    """Return the directions of all kept cells."""
    table = Table(np.zeros((*SHAPE, 1)))
    wi, wo = (w[:, :, : KEPT_SHAPE[2]].reshape(-1, 3) for w in table.directions())
    lowest = np.minimum(wi[:, 2], wo[:, 2]).reshape(KEPT_SHAPE)
    own = lowest > np.cos(LARGEST_ANGLE)
    # The source of a cell: the last one of its own at smaller θd, else at smaller θh
    h, d, p = np.meshgrid(*(np.arange(n) for n in KEPT_SHAPE), indexing="ij")
    last_d = np.maximum.accumulate(np.where(own, d, -1), axis=1)
    last_h = np.maximum.accumulate(np.where(last_d >= 0, h, -1), axis=0)
    source_d = np.take_along_axis(last_d, last_h, axis=0)
    source = to_flat_index((last_h, source_d, p), KEPT_SHAPE).reshape(-1)
    cosines = [np.clip(w[:, 2], 0, 1) for w in (wi, wo)]
    angles = [np.arccos(np.clip(w[:, 2], -1, 1)) for w in (wi, wo)]
    cosine = np.maximum(cosines[0] * cosines[1], LEAST_COSINE)
    return PriorCells(wi[source], wo[source], cosine, own.reshape(-1), *angles)


def find_nodes(wi: AnyArray, wo: AnyArray) -> tuple[IntArray, FloatArray]:
    """Return the kept cells around direction pairs (n, 3), and their shares, both (n, 8)."""
    theta_h, theta_d, phi_d = to_half_difference(wi, wo)
    n_h, n_d, n_p = SHAPE
    brackets = [
        find_bracket(np.sqrt(theta_h / (pi / 2)) * n_h - 0.5, n_h),
        find_bracket(theta_d / (pi / 2) * n_d - 0.5, n_d),
        find_periodic_bracket(phi_d / pi * n_p - 0.5, n_p),
    ]
    nodes, shares = [], []
    for (h, d, p), share in list_corners(brackets):
        nodes.append(to_flat_index((h, d, np.minimum(p, n_p - 1 - p)), KEPT_SHAPE))
        shares.append(share)
    return np.stack(nodes, axis=1), np.stack(shares, axis=1)


def compute_cosine(wi: AnyArray, wo: AnyArray) -> FloatArray:
    """Return c = max(cosθi cosθo, 0.05) of direction pairs (n, 3)."""
    return np.maximum(wi[:, 2] * wo[:, 2], LEAST_COSINE)


def to_logarithm(values: AnyArray, cosine: AnyArray) -> FloatArray:
    """Return ln(f c + e) of BRDF values f (..., n) [sr⁻¹], negative ones as 0, for c (n,)."""
    return np.log(np.maximum(values, 0) * cosine + OFFSET)


def from_logarithm(logarithm: AnyArray, cosine: AnyArray) -> FloatArray:
    """Return the BRDF [sr⁻¹], at least 0, of which `to_logarithm` made these logarithms."""
    return np.maximum(np.exp(logarithm) - OFFSET, 0) / cosine
