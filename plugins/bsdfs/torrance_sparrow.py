"""Torrance-Sparrow: a microfacet model of V-grooves with a Gaussian distribution of inclinations.

    f = k_d / π + k_s D G F / (4 (N·L)(N·V)),   D = exp(-θ_h² / m²) / (π m²)
    G = min(1, 2 (N·H)(N·V) / (V·H), 2 (N·H)(N·L) / (V·H))

N, L, V and H are the normal, the directions of light and view, and the half vector at the angle θ_h
to N; m is the rms inclination of the facets. [Torrance & Sparrow 1967]; [Kurt 2007, eqs.
3.25-3.27], with Schlick's Fresnel reflectance F (eq. 3.16). The constant of the distribution D
[Ramamoorthi & Hanrahan 2001] normalises D only for small m: ∫ D cosθ_h dω is 0.974 at m = 0.2 and
0.548 at m = 1, so that rough surfaces are too dark, never too bright. It suits metals and plastics
of one roughness with off-specular peaks, and has no long tails and no anisotropy.
"""

from dataclasses import dataclass

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitVector
from brdfkit.core.geometry.vectors import half_vector
from brdfkit.model import shape, weight
from brdfkit.model.fresnel import FresnelModel
from brdfkit.model.lobes import HalfVector, Lobe, lambertian
from brdfkit.model.microfacet import Visible, v_groove
from brdfkit.model.numerics import log1p


@dataclass(frozen=True)
class GaussianAngle:
    """A distribution of microfacet normals whose angle θ_h to the surface normal is Gaussian.

    θ_h has a density proportional to θ_h exp(-θ_h²/m²); `m` is its rms value [rad].
    """

    m: JitFloat

    def D(self, h: JitVector) -> JitFloat:
        x = _angle_to_normal(h) / self.m
        return dr.exp(-x * x) / (dr.pi * self.m * self.m)

    def sample(self, wi: JitVector, u: JitVector) -> JitVector:
        theta = self.m * dr.sqrt(-log1p(-u.x * self._compute_share_above_surface()))
        sin_theta, cos_theta = dr.sincos(theta)
        sin_phi, cos_phi = dr.sincos(2 * dr.pi * u.y)
        return type(wi)(sin_theta * cos_phi, sin_theta * sin_phi, cos_theta)

    def pdf(self, wi: JitVector, h: JitVector, cos_d: JitFloat) -> JitFloat:
        # The density is D θ_h / sinθ_h, divided by the share of the Gaussian above the surface
        return (
            self.D(h)
            * _angle_to_normal(h)
            / (_sine_to_normal(h) * self._compute_share_above_surface())
        )

    def _compute_share_above_surface(self) -> JitFloat:
        """Return the share of the Gaussian that lies at θ_h < π/2, above the surface."""
        end = dr.pi / 2 / self.m
        return 1 - dr.exp(-end * end)


def _sine_to_normal(h: JitVector) -> JitFloat:
    return dr.sqrt(dr.maximum(h.x * h.x + h.y * h.y, 1e-14))


def _angle_to_normal(h: JitVector) -> JitFloat:
    return dr.atan2(_sine_to_normal(h), h.z)


# The ball in the picture on the model's page: glazed porcelain
PICTURE = {
    "diffuse_reflectance": [0.7, 0.7, 0.72],
    "specular_reflectance": 1.0,
    "alpha": 0.08,
    "f0": 0.05,
}


class TorranceSparrow(FresnelModel):
    diffuse_reflectance = weight(0.4, "k_d: albedo of the diffuse term")
    specular_reflectance = weight(0.5, "k_s: strength of the highlight")
    alpha = shape(0.2, (0.001, 1.0), "m: rms inclination of the facets [rad]", log=True, width=1)
    f0 = shape(0.5, (0.0, 1.0), "F₀: Fresnel reflectance at normal incidence")

    def geometry_factor(self, wi: JitVector, wo: JitVector) -> JitFloat:
        return v_groove(wi, wo, half_vector(wi, wo)) / (4 * wi.z * wo.z)

    def lobes(self) -> tuple[Lobe, ...]:
        angles = GaussianAngle(self.alpha)
        sampling = HalfVector(Visible(angles))
        return lambertian(), *self.make_fresnel_lobes(angles.D, self.geometry_factor, sampling)
