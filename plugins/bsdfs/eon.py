"""EON: energy-preserving Oren-Nayar, matt facets with the light that they scatter to each other.

    f = ρ/π A (1 + r s/t) + ρ²/π (1 - E(N·L)) (1 - E(N·V)) / (1 - Ē)
    s = L·V - (N·L)(N·V),   t = max(N·L, N·V) where s > 0, else 1
    A = 1 / (1 + c₁ r),   E(μ) = A (1 + r G(μ) / π),   Ē = A (1 + c₂ r)
    G = sinθ (θ - sinθ cosθ) + 2/3 (tanθ (1 - sin³θ) - sinθ),   μ = cosθ

with c₁ = 1/2 - 2/3π, c₂ = 2/3 - 28/15π. N, L and V are the normal and the directions of light and
view, θ is the angle of either to N. ρ is the albedo of a facet, r the roughness. The first term is
the light that facets scatter once; E is its albedo at ρ = 1, Ē the mean of E. The second term is
the light that they scatter twice or more often.

[Portsmouth et al. 2025]; the first term is due to [Fujii 2013]. In the paper the second term has
the factor ρ² Ē / (1 - ρ (1 - Ē)); here it has ρ², the same at ρ = 1, since weights enter a model
only by their first and second power. So white surfaces reflect all light at every angle, as in the
paper. The albedo of other surfaces is larger than in the paper, by at most 0.007 or 1.2 %
(at r = 1). At r = 0 the model is Lambert's. It suits clay, plaster, cloth and the base layer of
paints: flat, with retro-reflection, without gloss.
"""

from brdfkit.core.array_types import JitFloat, JitVector
from brdfkit.model import Model, shape, weight
from brdfkit.model.lobes import Cosine, Lobe
from brdfkit.model.rough_diffuse import scatter_often, scatter_once

# The ball in the picture on the model's page: rough plaster, saturated by scattering between facets
PICTURE = {
    "diffuse_reflectance": [0.8, 0.62, 0.3],
    "roughness": 1.0,
}


class EON(Model):
    diffuse_reflectance = weight(0.5, "ρ: albedo of a facet")
    roughness = shape(0.5, (0.0, 1.0), "r: roughness of the facets")

    def single_scattering(self, wi: JitVector, wo: JitVector) -> JitFloat:
        return scatter_once(wi, wo, self.roughness)

    def multiple_scattering(self, wi: JitVector, wo: JitVector) -> JitFloat:
        return scatter_often(wi, wo, self.roughness)

    def lobes(self) -> tuple[Lobe, ...]:
        once, often = self.single_scattering, self.multiple_scattering
        return (Lobe(once, Cosine(), quadratic=often, diffuse=True),)
