"""Computes a BRDF's distribution of microfacet normals from its retro-reflection.

For wi = wo = w, the BRDF of a surface of microfacets with normals m is

    f(w, w) = F(0) D(w) / (4 cosθ σ(w)),    σ(w) = ∫ D(m) max(0, w·m) dm,

where F is Fresnel's reflectance, D the distribution of the normals, θ the angle of w to the
surface's normal and σ the projected area of the microfacets. So D is an eigenvector of the linear
map D → f(w, w) cosθ σ(w): the one without negative entries. Applying the map repeatedly converges
to it [Dupuy et al. 2015].
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.geometry.directions import from_angles

MOST_ITERATIONS = 200
TOLERANCE = 1e-6


@dataclass(frozen=True, eq=False)
class Hemisphere:
    """A grid of directions on the hemisphere, and integrals over it.

    `theta`: polar angles from 0 to π/2 [rad], (n_theta,); `n_phi`: number of azimuths, which are
    evenly spaced from -π on, or 1 if nothing depends on the azimuth.
    """

    theta: FloatArray
    n_phi: int

    @property
    def directions(self) -> FloatArray:
        """The grid's directions as unit vectors (n_phi, n_theta, 3)."""
        phi = -np.pi + 2 * np.pi * np.arange(self.n_phi) / self.n_phi
        return from_angles(self.theta, phi[:, None])

    @cached_property
    def solid_angles(self) -> FloatArray:
        """The solid angle of the ring at each theta (n_theta,) [sr], by the trapezoidal rule."""
        steps = np.diff(self.theta, prepend=self.theta[0], append=self.theta[-1])
        return 2 * np.pi * np.sin(self.theta) * (steps[1:] + steps[:-1]) / 2

    def integrate_over_plane(self, D: FloatArray) -> float:
        """Integrate ∫ D cosθ dm: the area of facets with normals distributed by D, seen from above.

        D is (n_phi, n_theta); for a distribution of normals the result should be 1.
        """
        return D.mean(axis=0) @ (self.solid_angles * np.cos(self.theta))

    def projected_area(self, D: FloatArray) -> FloatArray:
        """Return σ(w) = ∫ D(m) max(0, w·m) dm for all directions w of the grid, (n_phi, n_theta).

        It is the facets' area projected along w; D (n_phi, n_theta) is the distribution of normals.
        """
        # The integral over the azimuth is a convolution, so multiply the Fourier coefficients
        coefficients = np.fft.rfft(D * self.solid_angles, axis=0)
        projected = np.einsum("ijk,kj->ki", self._projection_kernel, coefficients)
        return np.fft.irfft(projected, self.n_phi, axis=0)

    @cached_property
    def _projection_kernel(self) -> FloatArray:
        """The Fourier coefficients of max(0, w·m) over the azimuth between w and m.

        `projected_area` needs them. The axes are the polar angle θ of w, the polar angle θ' of m,
        and the number k of the coefficient. For an azimuth Δφ, w·m = a + b cosΔφ with
        a = cosθ cosθ' and b = sinθ sinθ'. Its positive part is 0 beyond φ₀ = arccos(-a/b). The
        coefficients are (φ₀/π) (a s_k + b (s_{k-1} + s_{k+1}) / 2) with s_k = sin(k φ₀) / (k φ₀).
        """
        a, b = (np.multiply.outer(x, x) for x in (np.cos(self.theta), np.sin(self.theta)))
        a, b = a[..., None], b[..., None]
        phi_0 = np.arccos(-np.divide(a, b, out=np.ones_like(a), where=b > a))
        k = np.arange(self.n_phi // 2 + 1)
        before, here, after = (np.sinc((k + step) * phi_0 / np.pi) for step in (-1, 0, 1))
        return phi_0 / np.pi * (a * here + b * (before + after) / 2)


def find_normal_distribution(retro: FloatArray, hemisphere: Hemisphere) -> FloatArray:
    """Return the distribution of normals D (n_phi, n_theta) [sr⁻¹] that explains `retro`.

    `retro` (n_phi, n_theta) are the values f(w, w) of the BRDF, which must not be negative. D is
    found by power iteration, and scaled to ∫ D cosθ dm = 1.
    """
    gain = retro * np.cos(hemisphere.theta)
    D = np.ones_like(gain)
    for _ in range(MOST_ITERATIONS):
        previous, D = D, gain * hemisphere.projected_area(D)
        D = D / hemisphere.integrate_over_plane(D)
        if np.abs(D - previous).max() < TOLERANCE * D.max():
            break
    return D
