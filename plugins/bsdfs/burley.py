"""Burley: the diffuse term of Disney's model, darker or brighter than Lambert at grazing angles.

    f = k_d / π (1 + (F₉₀ - 1) (1 - N·L)⁵) (1 + (F₉₀ - 1) (1 - N·V)⁵)
    F₉₀ = 1/2 + 2 r (V·H)²

N, L, V and H are the normal, the directions of light and view, and the half vector. [Burley 2012]
found this formula from the materials of the MERL database. At grazing angles smooth surfaces are
darker, because less light is refracted into the base layer, and rough surfaces are brighter,
because they reflect light back to where it came from. The albedo of a white surface at normal
incidence is 0.98 for the roughness r = 0 and 1.04 for r = 1. At 85° it is 0.67 and 1.40, so rough
surfaces conserve energy only if they are darker. It suits the base layer of plastics, paints and
cloth, without gloss. The sum "burley+ggx" adds a highlight.
"""

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitVector
from brdfkit.core.geometry.vectors import cos_theta_d
from brdfkit.model import Model, shape, weight
from brdfkit.model.lobes import Cosine, Lobe
from brdfkit.model.microfacet import fifth_power

# The ball in the picture on the model's page: felt, which is brighter at its rim
PICTURE = {
    "diffuse_reflectance": [0.12, 0.35, 0.2],
    "roughness": 1.0,
}


class Burley(Model):
    diffuse_reflectance = weight(0.5, "k_d: approximately the albedo")
    roughness = shape(0.5, (0.0, 1.0), "r: roughness")

    def diffuse_brdf(self, wi: JitVector, wo: JitVector) -> JitFloat:
        rise = 2 * self.roughness * dr.square(cos_theta_d(wi, wo)) - 0.5  # F₉₀ - 1 of the formula
        entering, leaving = 1 + rise * fifth_power(1 - wi.z), 1 + rise * fifth_power(1 - wo.z)
        return entering * leaving / dr.pi

    def lobes(self) -> tuple[Lobe, ...]:
        return (Lobe(self.diffuse_brdf, Cosine(), diffuse=True),)
