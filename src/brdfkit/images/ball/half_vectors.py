"""Draws the directions to which a material reflects, by the values of its BRDF over theta_h.

A density p_h of half vectors h is the density p_h / (4 wo·h) of the directions that they reflect.
"""

from collections.abc import Callable
from typing import Any, TypeAlias

import numpy as np

from brdfkit.core.array_types import AnyArray
from brdfkit.core.geometry.directions import from_angles, from_half_difference, normalize

# Cells in theta_h, even in its square root, as in a table [Matusik et al. 2003]
CELLS = 90
# Angles at which the BRDF is computed for each cell [degrees]
THETA_D, PHI_D, PHI_H = (5, 20, 35, 50, 65), (0, 45, 90, 135), (0, 90, 180, 270)
# The least density of half vectors, as a share of the mean one
FLOOR = 1e-3

Brdf: TypeAlias = Callable[[Any, Any], Any]  # (wi, wo), each (n, 3) → values (n, channels)


class HalfVectors:
    """The distribution of half vectors of a BRDF, constant in each cell of theta_h.

    Its density is the mean of the BRDF's values in the cell, times cosθ_h.
    """

    def __init__(self, brdf: Brdf) -> None:
        theta_h = ((np.arange(CELLS) + 0.5) / CELLS) ** 2 * np.pi / 2
        angles = (theta_h, *map(np.radians, (THETA_D, PHI_D, PHI_H)))
        wi, wo = from_half_difference(*np.meshgrid(*angles, indexing="ij"))
        values = np.asarray(brdf(wi.reshape(-1, 3), wo.reshape(-1, 3)))
        means = np.maximum(values, 0).reshape(CELLS, -1).mean(axis=1)
        # 1 - cosθ_h, which keeps its digits near the normal
        self.versines = 2 * np.sin((np.arange(CELLS + 1) / CELLS) ** 2 * np.pi / 4) ** 2
        areas = 2 * np.pi * np.diff(self.versines)
        masses = means * np.cos(theta_h) * areas
        masses += FLOOR * (masses.sum() or 1.0) * areas / areas.sum()
        self.sums = np.cumsum(masses / masses.sum())
        self.densities = masses / masses.sum() / areas

    def draw(self, u: AnyArray) -> AnyArray:
        """Draw half vectors (n, 3) for points `u` (n, 3) of the unit cube."""
        cell = np.minimum(np.searchsorted(self.sums, u[:, 0]), CELLS - 1)
        versine = self.versines[cell] + np.diff(self.versines)[cell] * u[:, 1]
        return from_angles(2 * np.arcsin(np.sqrt(versine / 2)), 2 * np.pi * u[:, 2])

    def density(self, theta_h: AnyArray) -> AnyArray:
        """Return the densities per solid angle of half vectors at polar angles `theta_h` [rad]."""
        cell = (np.sqrt(theta_h / (np.pi / 2)) * CELLS).astype(int)
        return np.where(cell < CELLS, self.densities[np.minimum(cell, CELLS - 1)], 0.0)

    def sample(self, wo: AnyArray, u: AnyArray) -> AnyArray:
        """Draw directions (n, 3) that are reflected to `wo` (n, 3), for points `u` of the cube.

        They may lie below the surface.
        """
        h = self.draw(u)
        return 2 * (h * wo).sum(axis=1, keepdims=True) * h - wo

    def pdf(self, wi: AnyArray, wo: AnyArray) -> AnyArray:
        """Return the densities (n,) per solid angle of the directions `wi` (n, 3)."""
        h = normalize(wi + wo)
        theta_h = np.arctan2(np.hypot(h[:, 0], h[:, 1]), h[:, 2])
        return self.density(theta_h) / (4 * np.maximum((h * wo).sum(axis=1), 1e-9))
