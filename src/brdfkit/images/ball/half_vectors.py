"""Draws directions from which a material reflects light to the eye, mostly where its BRDF is large.

Half vectors h are drawn with a tabulated density over theta_h, their angle to the normal. A density
p_h of half vectors is the density p_h / (4 wo·h) of the directions that they reflect to wo.
"""

from collections.abc import Callable
from typing import Any, TypeAlias

import numpy as np

from brdfkit.core.array_types import AnyArray
from brdfkit.core.geometry.directions import from_angles, from_half_difference, normalize

CELLS = 90  # number of cells of theta_h, with equal steps of √theta_h [Matusik et al. 2003]
# The other Rusinkiewicz angles [degrees], at which the BRDF is averaged for each cell of theta_h
THETA_D, PHI_D, PHI_H = (5, 20, 35, 50, 65), (0, 45, 90, 135), (0, 90, 180, 270)
FLOOR = 1e-3  # smallest density of half vectors, relative to the mean density

Brdf: TypeAlias = Callable[[Any, Any], Any]  # wi (n, 3), wo (n, 3) → values (n, channels)


class HalfVectors:
    """A distribution of half vectors for drawing directions in proportion to a BRDF.

    In each cell of theta_h, the half vector's angle to the normal, the density is constant: the
    mean of the BRDF's values, times cosθ_h.
    """

    def __init__(self, brdf: Brdf) -> None:
        theta_h = ((np.arange(CELLS) + 0.5) / CELLS) ** 2 * np.pi / 2
        angles = (theta_h, *map(np.radians, (THETA_D, PHI_D, PHI_H)))
        wi, wo = from_half_difference(*np.meshgrid(*angles, indexing="ij"))
        values = np.asarray(brdf(wi.reshape(-1, 3), wo.reshape(-1, 3)))
        means = np.maximum(values, 0).reshape(CELLS, -1).mean(axis=1)
        # The versine 1 - cosθ_h, unlike the cosine, loses no digits near the normal
        self.versines = 2 * np.sin((np.arange(CELLS + 1) / CELLS) ** 2 * np.pi / 4) ** 2
        areas = 2 * np.pi * np.diff(self.versines)
        masses = means * np.cos(theta_h) * areas
        masses += FLOOR * (masses.sum() or 1.0) * areas / areas.sum()
        self.sums = np.cumsum(masses / masses.sum())
        self.densities = masses / masses.sum() / areas

    def draw_half_vectors(self, u: AnyArray) -> AnyArray:
        """Draw half vectors (n, 3) by random points `u` (n, 3) of the unit cube."""
        cell = np.minimum(np.searchsorted(self.sums, u[:, 0]), CELLS - 1)
        versine = self.versines[cell] + np.diff(self.versines)[cell] * u[:, 1]
        return from_angles(2 * np.arcsin(np.sqrt(versine / 2)), 2 * np.pi * u[:, 2])

    def density(self, theta_h: AnyArray) -> AnyArray:
        """Return the density per solid angle [sr⁻¹] of half vectors at angles `theta_h` [rad]."""
        cell = (np.sqrt(theta_h / (np.pi / 2)) * CELLS).astype(int)
        return np.where(cell < CELLS, self.densities[np.minimum(cell, CELLS - 1)], 0.0)

    def sample(self, wo: AnyArray, u: AnyArray) -> AnyArray:
        """Draw incident directions (n, 3) whose light is reflected to `wo` (n, 3).

        `u` (n, 3) are random points of the unit cube. Directions may lie below the surface.
        """
        h = self.draw_half_vectors(u)
        return 2 * (h * wo).sum(axis=1, keepdims=True) * h - wo

    def pdf(self, wi: AnyArray, wo: AnyArray) -> AnyArray:
        """Return the densities (n,) [sr⁻¹] with which `sample` draws `wi` (n, 3) for `wo`."""
        h = normalize(wi + wo)
        theta_h = np.arctan2(np.hypot(h[:, 0], h[:, 1]), h[:, 2])
        return self.density(theta_h) / (4 * np.maximum((h * wo).sum(axis=1), 1e-9))
