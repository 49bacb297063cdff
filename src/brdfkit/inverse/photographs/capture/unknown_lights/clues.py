"""Measures how far scaled normals A b look like those of an object, for any matrix A (3, 3).

With the rows a_i of A and the slopes p = -n_x / n_z and q = -n_y / n_z of the normals n = A b,
those of a surface have ∂p/∂y = ∂q/∂x [Yuille & Snow 1997]. Both sides are, up to a factor,

    n_z² ∂p/∂y = -(a_3 × a_1) · (b × ∂b/∂y)  and  n_z² ∂q/∂x = -(a_3 × a_2) · (b × ∂b/∂x).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from brdfkit.core.array_types import FloatArray
from brdfkit.inverse.photographs.capture.diagnosis.frame import find_outline
from brdfkit.inverse.photographs.capture.unknown_lights.factors import Factors

SMOOTHING = 1.5  # pixels, of b before it is differentiated
MARGIN = 3  # pixels at the outline where b is not differentiated
# Shares of the measures in the sum of their logarithms, and what is added to each of them
ALBEDO_SHARE, LIGHT_SHARE = 1.0, 0.3
OUTLINE_FLOOR, ALBEDO_FLOOR, LIGHT_FLOOR = 0.002, 0.002, 0.02
BACK_SHARE = 2.0  # of the share of normals that point away from the camera
MOST = 0.5  # largest deviation of an albedo or a strength that counts


@dataclass(frozen=True, eq=False)
class Clues:
    """What is known of the factors of an object's photographs.

    `inner` (m, 3): b of pixels off the outline; `across_y`, `across_x` (m, 3): b × ∂b/∂y and
    b × ∂b/∂x; `outer` (e, 3): b at the outline; `outward` (e, 2): unit vectors there; `lit` (l, 3):
    b of pixels that few shadows reach; `lights` (lights, 3).
    """

    inner: FloatArray
    across_y: FloatArray
    across_x: FloatArray
    outer: FloatArray
    outward: FloatArray
    lit: FloatArray
    lights: FloatArray

    @classmethod
    def collect(cls, factors: Factors) -> Clues:
        """Return the clues in the factors of photographs."""
        mask = factors.mask
        picture = np.zeros((*mask.shape, 3))
        picture[mask] = factors.normals
        within = np.maximum(ndimage.gaussian_filter(mask.astype(float), SMOOTHING), 1e-6)
        smooth = ndimage.gaussian_filter(picture, (SMOOTHING, SMOOTHING, 0)) / within[..., None]
        inside = ndimage.binary_erosion(mask, iterations=MARGIN)
        edge, outward = find_outline(mask)
        b = smooth[inside]
        return cls(
            inner=b,
            across_y=np.cross(b, -np.gradient(smooth, axis=0)[inside]),
            across_x=np.cross(b, np.gradient(smooth, axis=1)[inside]),
            outer=factors.normals[edge[mask]],
            outward=outward,
            lit=factors.normals[factors.lit],
            lights=factors.lights,
        )

    def measure_shape(self, matrix: FloatArray) -> float:
        """Return how little normals are those of a surface with this outline, as a logarithm."""
        length = np.maximum(((self.inner @ matrix.T) ** 2).sum(axis=1), 1e-300)
        p_y = self.across_y @ np.cross(matrix[2], matrix[0]) / length
        q_x = self.across_x @ np.cross(matrix[2], matrix[1]) / length
        curl = np.abs(p_y - q_x).sum() / max((np.abs(p_y) + np.abs(q_x)).sum(), 1e-300)
        sideways = self.outer @ matrix[:2].T
        cosine = (sideways * self.outward).sum(axis=1)
        cosine = cosine / np.maximum(np.linalg.norm(sideways, axis=1), 1e-300)
        inward = np.minimum(1 - cosine, 1).mean() + OUTLINE_FLOOR
        back = (self.inner @ matrix[2] < 0).mean()
        return float(np.log(max(curl, 1e-9)) + np.log(inward) + BACK_SHARE * back)

    def measure_all(self, matrix: FloatArray) -> float:
        """Return `measure_shape`, and how little albedos and strengths of lights are equal."""
        albedo = _measure_spread(self.lit @ matrix.T) + ALBEDO_FLOOR
        strengths = _measure_spread(np.linalg.solve(matrix.T, self.lights.T).T) + LIGHT_FLOOR
        equality = ALBEDO_SHARE * np.log(albedo) + LIGHT_SHARE * np.log(strengths)
        return self.measure_shape(matrix) + float(equality)


def _measure_spread(vectors: FloatArray) -> float:
    """Return the mean deviation of the lengths of vectors from their median, as a share of it."""
    lengths = np.linalg.norm(vectors, axis=1)
    return float(np.minimum(np.abs(lengths / np.median(lengths) - 1), MOST).mean())
