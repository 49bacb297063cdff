"""EON: energy-preserving Oren-Nayar, matt facets and the light that bounces between them.

    f = ρ/π A (1 + r s/t) + ρ²/π (1 - E(N·L)) (1 - E(N·V)) / (1 - Ē)
    s = L·V - (N·L)(N·V),   t = max(N·L, N·V) where s > 0, else 1
    A = 1 / (1 + c₁ r),   E(μ) = A (1 + r G(μ) / π),   Ē = A (1 + c₂ r)
    G = sinθ (θ - sinθ cosθ) + 2/3 (tanθ (1 - sin³θ) - sinθ),   μ = cosθ

with c₁ = 1/2 - 2/3π, c₂ = 2/3 - 28/15π. E is the albedo of the first term at ρ = 1, Ē its mean.

[Portsmouth et al. 2025]; the first term is [Fujii 2013]'s. The paper's second term has the factor
ρ² Ē / (1 - ρ (1 - Ē)), light scattered twice and more often; here its value at ρ = 1, ρ², stands
for every ρ, since a weight counts with its first and second power only. So white surfaces reflect
all light at every angle, as in the paper; others are brighter than there, by at most 0.007 or 1.2 %
of the albedo (where r = 1). Lambert at r = 0. Shows clay, plaster, cloth and the ground of
paints, flat and with retro-reflection; no gloss.
"""

import math

import drjit as dr

from brdfkit.core.geometry.vectors import dot
from brdfkit.model import Model, shape, weight
from brdfkit.model.lobes import Cosine, Lobe

C1, C2 = 1 / 2 - 2 / (3 * math.pi), 2 / 3 - 28 / (15 * math.pi)


# The ball of its page: rough plaster, whose light between facets is more saturated
PICTURE = {
    "diffuse_reflectance": [0.8, 0.62, 0.3],
    "roughness": 1.0,
}


class EON(Model):
    diffuse_reflectance = weight(0.5, "ρ: albedo of a facet")
    roughness = shape(0.5, (0.0, 1.0), "r: roughness of the facets")

    def once(self, wi, wo):
        s = dot(wi, wo) - wi.z * wo.z
        t = dr.select(s > 0, dr.maximum(wi.z, wo.z), 1)
        return self.A() * (1 + self.roughness * s / t) / dr.pi

    def again(self, wi, wo):
        # Divided by r A, which 1 - E and 1 - Ē have as a factor
        return self.roughness * self.A() * lost(wi.z) * lost(wo.z) / ((C1 - C2) * dr.pi)

    def A(self):
        return 1 / (1 + C1 * self.roughness)

    def lobes(self):
        return (Lobe(self.once, Cosine(), quadratic=self.again, diffuse=True),)


def lost(cosine):
    """(1 - E) / (r A) = c₁ - G/π at this cosine; it falls to 0 at the horizon."""
    sine = dr.sqrt(dr.maximum(1 - cosine * cosine, 1e-14))
    grazing = sine * cosine * (1 + sine + sine * sine) / (1 + sine)  # tanθ (1 - sin³θ)
    G = sine * (dr.safe_acos(cosine) - sine * cosine) + 2 / 3 * (grazing - sine)
    return C1 - G / dr.pi
