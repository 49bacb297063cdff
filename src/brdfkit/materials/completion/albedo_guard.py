"""Keeps the albedo of a completed material at or below 1, without losing its reciprocity.

With the directional albedo a(θ), the BRDF f becomes f / max(1, a(θi), a(θo)): the integral of
f cosθo over wo is then at most 1 for every wi.
"""

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.geometry.directions import from_angles
from brdfkit.materials.measured.albedos import compute_directional_albedo
from brdfkit.model.samples import Table

ANGLES = np.radians([0, 10, 20, 30, 40, 50, 60, 65, 70, 75, 80, 83, 86, 88, 89.5])
ROUNDS = 4  # interpolation between cells leaves a little, which the next round takes


def limit_albedo(table: Table) -> FloatArray:
    """Return the factors (*shape, channels), at most 1, that limit the albedo of a `table` to 1."""
    wi, wo = table.directions()
    angles = [np.arccos(np.clip(w[..., 2], 0, 1)) for w in (wi, wo)]
    factors: FloatArray = np.ones(table.values.shape)
    for _ in range(ROUNDS):
        albedo = compute_albedos(Table(table.values * factors, table.phi_d_period))
        if albedo.max() <= 1:
            break
        excess = np.maximum(albedo, 1)
        for channel in range(factors.shape[-1]):
            at_i, at_o = (np.interp(angle, ANGLES, excess[:, channel]) for angle in angles)
            factors[..., channel] /= np.maximum(at_i, at_o)
    return factors


def compute_albedos(table: Table) -> FloatArray:
    """Return the directional albedos (angles, channels) of a table at `ANGLES`."""
    return np.array([compute_directional_albedo(table, from_angles(a, 0.0)) for a in ANGLES])
