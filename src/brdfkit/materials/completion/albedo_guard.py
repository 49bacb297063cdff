"""Keeps the albedo of a completed material at or below 1, without losing its reciprocity.

With the directional albedo a(θ), the BRDF f becomes f / max(1, a(θi), a(θo)): the integral of
f cosθo over wo is then at most 1 for every wi.
"""

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.geometry.directions import from_angles
from brdfkit.materials.measured.albedos import compute_directional_albedo
from brdfkit.model.samples import Table

# Angles of incidence: few are tried of materials that reflect clearly less than all light, of all
# others the centres of the cells and, near the horizon, what is between them
FEW = np.radians([0, 10, 20, 30, 40, 50, 60, 65, 70, 75, 80, 83, 86, 88, 89.5])
ANGLES = np.radians([0, *np.arange(1.5, 60, 3), *np.arange(60, 78, 1.5), *np.arange(78, 90, 0.75)])
CLEARLY_LESS = 0.9
# Of a larger albedo, the values are wild, and the quadrature is so many times as fine
WILD, FINER = 1.5, 3
LARGEST = 0.999  # a little below 1, for the angles that are not tried
ROUNDS = 3  # interpolation between cells leaves a little, which the next round takes


def limit_albedo(table: Table) -> FloatArray:
    """Return the factors (*shape, channels), at most 1, that limit the albedo of a `table` to 1."""
    factors: FloatArray = np.ones(table.values.shape)
    largest = compute_albedos(table, FEW).max()
    if largest < CLEARLY_LESS:
        return factors
    finer = FINER if largest > WILD else 1
    theta = [np.arccos(np.clip(w[..., 2], 0, 1)) for w in table.directions()]
    for _ in range(ROUNDS):
        excess = _compute_excess(table, factors, finer)
        if excess.max() <= 1:
            return factors
        for channel in range(factors.shape[-1]):
            at_i, at_o = (np.interp(angle, ANGLES, excess[:, channel]) for angle in theta)
            factors[..., channel] /= np.maximum(at_i, at_o)
    # What is left, at most a few per cent, is taken from all cells alike
    return factors / _compute_excess(table, factors, finer).max(axis=0)


def _compute_excess(table: Table, factors: FloatArray, finer: int) -> FloatArray:
    """Return by what the albedos of a table times `factors` are too large, at least 1."""
    limited = Table(table.values * factors, table.phi_d_period)
    return np.maximum(compute_albedos(limited, ANGLES, finer) / LARGEST, 1)


def compute_albedos(table: Table, angles: FloatArray, finer: int = 1) -> FloatArray:
    """Return the directional albedos (angles, channels) of a table at angles of incidence [rad]."""
    wi = from_angles(angles, 0.0)
    return np.array([compute_directional_albedo(table, w, finer) for w in wi])
