"""`MeasuredAngles`: which directions of light and view a measurement holds, for each pixel."""

from __future__ import annotations

import numpy as np

from brdfkit.core.array_types import AnyArray, BoolArray, FloatArray
from brdfkit.core.geometry.directions import from_angles
from brdfkit.materials.measured import Measured
from brdfkit.materials.measured.coverage import is_near_sample

ANGLES, TURNS = 30, 60  # cells of the polar angles up to 90°, and of the azimuths between
LEAST_SHARE = 0.5  # of the light of a view that should be measured


class MeasuredAngles:
    """Which polar angles of light and view, and azimuths between, a measurement holds.

    Of an anisotropic material, the azimuth of the view itself does not count: one is enough.
    """

    def __init__(self, data: Measured) -> None:
        theta = (np.arange(ANGLES) + 0.5) * np.pi / 2 / ANGLES
        turn = (np.arange(TURNS) + 0.5) * 2 * np.pi / TURNS
        grid = np.meshgrid(theta, theta, turn, indexing="ij")
        light, view, between = (angles.ravel() for angles in grid)
        known = np.zeros(len(light), bool)
        for first in np.arange(0, 360, 30) if data.anisotropic else (0.0,):
            azimuth = np.radians(first) + 0 * between
            wi, wo = from_angles(light, azimuth + between), from_angles(view, azimuth)
            known |= is_near_sample(data, wi, wo)
        self.known = known.reshape(grid[0].shape)
        weight = np.sin(theta) * np.cos(theta)
        shares = np.einsum("i,ijk->j", weight, self.known) / weight.sum() / TURNS
        self.views = shares >= LEAST_SHARE

    def knows_views(self, view: FloatArray) -> BoolArray:
        """Return whether most light for the directions (..., 3) of views was measured."""
        return self.views[_find_angle(view)]

    def knows(self, light: FloatArray, view: FloatArray) -> BoolArray:
        """Return whether pairs of directions (..., 3) about the normal z were measured."""
        azimuth = np.arctan2(light[..., 1], light[..., 0]) - np.arctan2(view[..., 1], view[..., 0])
        between = (azimuth / (2 * np.pi) * TURNS).astype(int) % TURNS
        return self.known[_find_angle(light), _find_angle(view), between]


def _find_angle(direction: FloatArray) -> AnyArray:
    """Return the cell of the polar angle of directions (..., 3)."""
    theta = np.arccos(np.clip(direction[..., 2], 0, 1))
    return np.minimum((theta / (np.pi / 2) * ANGLES).astype(int), ANGLES - 1)
