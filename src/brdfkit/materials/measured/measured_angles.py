"""`MeasuredAngles`: which directions of light and view a measurement holds, for each pixel."""

from __future__ import annotations

import numpy as np

from brdfkit.core.array_types import AnyArray, BoolArray, FloatArray
from brdfkit.core.geometry.directions import from_angles
from brdfkit.materials.measured import Measured
from brdfkit.materials.measured.coverage import is_near_sample
from brdfkit.materials.measured.evidence import GUESSED, INFERRED, MEASURED, find_evidence

ANGLES, TURNS = 30, 60  # cells of the polar angles up to 90°, and of the azimuths between
LEAST_SHARE = 0.5  # of the light of a view that should be measured


class MeasuredAngles:
    """Which polar angles of light and view, and azimuths between, a measurement holds.

    `kinds` (light, view, between) are 0 where it was measured, 2 where not; a completed material
    has 1 where its value was inferred, and 2 where it is a guess. Of an anisotropic material, the
    azimuth of the view itself does not count: one is enough.
    """

    def __init__(self, data: Measured) -> None:
        self.is_completed = data.evidence is not None
        theta = (np.arange(ANGLES) + 0.5) * np.pi / 2 / ANGLES
        turn = (np.arange(TURNS) + 0.5) * 2 * np.pi / TURNS
        grid = np.meshgrid(theta, theta, turn, indexing="ij")
        light, view, between = (angles.ravel() for angles in grid)
        kinds = np.full(len(light), GUESSED, np.uint8)
        for first in np.arange(0, 360, 30) if data.anisotropic else (0.0,):
            azimuth = np.radians(first) + 0 * between
            wi, wo = from_angles(light, azimuth + between), from_angles(view, azimuth)
            if self.is_completed:
                kinds = find_evidence(data, wi, wo).astype(np.uint8)
            else:
                kinds[is_near_sample(data, wi, wo)] = MEASURED
        self.kinds = kinds.reshape(grid[0].shape)
        weight = np.sin(theta) * np.cos(theta)
        self.view_kinds = np.zeros(ANGLES, np.uint8)
        for kind in (MEASURED, INFERRED):
            shares = np.einsum("i,ijk->j", weight, self.kinds <= kind) / weight.sum() / TURNS
            self.view_kinds += shares < LEAST_SHARE

    def find_view_kinds(self, cosine: FloatArray) -> AnyArray:
        """Return what most light for views is, by cosines to the normal, as `kinds` says it."""
        return self.view_kinds[_find_angle(cosine)]

    def find_kinds(self, light: FloatArray, view: FloatArray) -> AnyArray:
        """Return what pairs of directions (..., 3) about the normal z are, as `kinds` says it."""
        azimuth = np.arctan2(light[..., 1], light[..., 0]) - np.arctan2(view[..., 1], view[..., 0])
        between = (azimuth / (2 * np.pi) * TURNS).astype(int) % TURNS
        return self.kinds[_find_angle(light[..., 2]), _find_angle(view[..., 2]), between]

    def knows(self, light: FloatArray, view: FloatArray) -> BoolArray:
        """Return whether pairs of directions (..., 3) about the normal z were measured."""
        known: BoolArray = self.find_kinds(light, view) == MEASURED
        return known


def _find_angle(cosine: FloatArray) -> AnyArray:
    """Return the cell of the polar angle with this cosine."""
    theta = np.arccos(np.clip(cosine, 0, 1))
    return np.minimum((theta / (np.pi / 2) * ANGLES).astype(int), ANGLES - 1)
