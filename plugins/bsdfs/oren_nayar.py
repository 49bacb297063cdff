"""Oren-Nayar: matt facets in V-grooves, which reflect more light back than Lambert's surface.

    form=qualitative   f = k_d / π (A + B max(0, cosΔφ) sinα tanβ)
    form=full          f = k_d / π [C₁ + cosΔφ C₂ tanβ + (1 - |cosΔφ|) C₃ tan((α + β)/2)]
                         + 0.17 k_d² / π · σ² / (σ² + 0.13) [1 - cosΔφ (2β/π)²]

θ_i and θ_o are the angles of the directions of light and view to the normal, α is the greater and β
the smaller of them, Δφ is the difference of their azimuths, and σ the standard deviation of the
facets' inclination. The bracket of the full form is clamped at 0: for rough facets it is below 0
near the horizon, opposite to the light. A = C₁ = 1 - 0.5 σ² / (σ² + 0.33), B = 0.45 σ² / (σ² +
0.09), C₂ = B (sinα, less (2β/π)³ where cosΔφ < 0), C₃ = 0.125 σ² / (σ² + 0.09) (4αβ/π²)². The term
with k_d² is light reflected between facets.

[Oren & Nayar 1994]; [Kurt 2007, eqs. 3.18-3.24]. (In the printed eq. 3.23 the bracket closes too
early, which would make surfaces black at normal incidence.) At σ = 0 the model is Lambert's. It
suits clay, plaster, cloth and the moon: flat, with retro-reflection at grazing angles, without
gloss. With k_d = 1 the full form reflects up to 5 % more light than arrives at grazing incidence.
"""

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitVector
from brdfkit.model import Model, option, shape, weight
from brdfkit.model.lobes import Cosine, Lobe

# The ball in the picture on the model's page: fired clay, as bright at its rim as in its middle
PICTURE = {
    "diffuse_reflectance": [0.62, 0.3, 0.18],
    "sigma": 0.8,
}


class OrenNayar(Model):
    form = option("qualitative", ("qualitative", "full"), "the short form, or all its terms")
    diffuse_reflectance = weight(0.5, "k_d: albedo of a facet")
    sigma = shape(0.2, (0.0, 1.5), "σ: standard deviation of the facets' inclination [rad]")

    def qualitative_brdf(self, wi: JitVector, wo: JitVector) -> JitFloat:
        A, B, _ = self.roughness_factors()
        # Equals max(0, cosΔφ) sinα tanβ, without trigonometric functions
        towards = dr.maximum(wi.x * wo.x + wi.y * wo.y, 0) / dr.maximum(wi.z, wo.z)
        return (A + B * towards) / dr.pi

    def full_brdf(self, wi: JitVector, wo: JitVector) -> JitFloat:
        C1, B, _ = self.roughness_factors()
        alpha, beta, cos_phi = find_angles(wi, wo)
        less = dr.select(cos_phi < 0, (2 * beta / dr.pi) ** 3, 0)
        C2 = B * (dr.sin(alpha) - less)
        C3 = 0.125 / 0.45 * B * dr.square(4 * alpha * beta / dr.pi**2)
        across = (1 - dr.abs(cos_phi)) * C3 * dr.tan((alpha + beta) / 2)
        # For rough facets the formula is below 0 near the horizon on the side opposite to the light
        return dr.maximum(C1 + cos_phi * C2 * dr.tan(beta) + across, 0) / dr.pi

    def interreflection(self, wi: JitVector, wo: JitVector) -> JitFloat:
        _, _, share = self.roughness_factors()
        _, beta, cos_phi = find_angles(wi, wo)
        return 0.17 / dr.pi * share * (1 - cos_phi * dr.square(2 * beta / dr.pi))

    def roughness_factors(self) -> tuple[JitFloat, JitFloat, JitFloat]:
        """Return the factors that depend on σ alone: A = C₁, B and σ² / (σ² + 0.13)."""
        s = self.sigma * self.sigma
        return 1 - 0.5 * s / (s + 0.33), 0.45 * s / (s + 0.09), s / (s + 0.13)

    def lobes(self) -> tuple[Lobe, ...]:
        if self.form == "qualitative":
            return (Lobe(self.qualitative_brdf, Cosine(), diffuse=True),)
        return (Lobe(self.full_brdf, Cosine(), quadratic=self.interreflection, diffuse=True),)


def find_angles(wi: JitVector, wo: JitVector) -> tuple[JitFloat, JitFloat, JitFloat]:
    """Return α and β, the larger and the smaller angle to the normal [rad], and cosΔφ.

    Δφ is the difference of the azimuths; cosΔφ is 0 where a direction is the normal.
    """
    high, low = dr.minimum(wi.z, wo.z), dr.maximum(wi.z, wo.z)
    sines = dr.sqrt(dr.maximum((1 - wi.z * wi.z) * (1 - wo.z * wo.z), 1e-20))
    cos_phi = dr.maximum(dr.minimum((wi.x * wo.x + wi.y * wo.y) / sines, 1), -1)
    return dr.safe_acos(high), dr.safe_acos(low), cos_phi
