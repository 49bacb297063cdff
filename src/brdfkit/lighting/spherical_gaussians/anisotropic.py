"""`AnisotropicGaussian`: a lobe with an elliptic cap, for brushed metal and for grazing views.

    G(v) = max(v·z, 0) e^(-λ (v·x)² - μ (v·y)²)

with an orthonormal frame x, y, z and bandwidths λ, μ > 0. Seen along z it is a Gaussian of the
plane, since v·z dω is the area of the plane: hence its integral and its moments. λ = μ = κ / 2 is
nearly a von Mises-Fisher lobe of κ. [Xu et al. 2013]
"""

from dataclasses import dataclass

import numpy as np

from brdfkit.core.geometry.directions import normalize
from brdfkit.lighting.spherical_gaussians.von_mises_fisher import tangents


@dataclass(frozen=True)
class AnisotropicGaussian:
    """One lobe: `frame` (3, 3) has the rows x, y, z, `bandwidths` (2,) are λ and μ."""

    frame: np.ndarray
    bandwidths: np.ndarray

    def eval(self, v):
        """G at directions `v` (..., 3); 1 at z."""
        x, y, z = np.moveaxis(v @ self.frame.T, -1, 0)
        along_x, along_y = self.bandwidths
        return np.maximum(z, 0) * np.exp(-along_x * x**2 - along_y * y**2)

    def integral(self):
        """∫ G dω = π / √(λμ), but for what a Gaussian of the plane has beyond the unit disc."""
        return np.pi / np.sqrt(self.bandwidths.prod())

    def to_light(self, view):
        """This lobe of half vectors as that of light for a `view` (3,): see `warp` for round ones.

        i = 2 (o·h) h - o is linear about z: it stretches by 2 along the plane of incidence, by
        2 (o·z) across it. At z, G is that of z; its integral is larger by 4 (o·z).
        """
        h = self.frame[2]
        cosine = view @ h
        axis = 2 * cosine * h - view
        plane = np.array(tangents(axis))
        # Columns: where x and y of the frame go, in the plane across the new axis
        moved = 2 * (np.outer(self.frame[:2] @ view, h) + cosine * self.frame[:2]) @ plane.T
        back = np.linalg.inv(moved.T)
        return _of_form(axis, plane, back.T @ np.diag(self.bandwidths) @ back)


def fit(x, weights):
    """The lobe with the mean and the second moments of directions `x` (n, 3) with `weights`."""
    axis = normalize(weights @ x)
    plane = np.array(tangents(axis))
    flat = x @ plane.T
    moments = (weights[:, None] * flat).T @ flat / weights.sum()
    return _of_form(axis, plane, np.linalg.inv(2 * moments))  # <x²> = 1 / 2λ


def _of_form(axis, plane, form):
    """The lobe about `axis` with exponent -uᵀ `form` u, of u in the `plane` (2, 3)."""
    bandwidths, directions = np.linalg.eigh(form)
    x, y = directions.T @ plane
    return AnisotropicGaussian(np.array([x, y, axis]), bandwidths)
