"""Burley: the diffuse term of Disney's model, dimmer or brighter than Lambert towards grazing.

    f = k_d / π (1 + (F₉₀ - 1) (1 - N·L)⁵) (1 + (F₉₀ - 1) (1 - N·V)⁵)
    F₉₀ = 1/2 + 2 r (V·H)²

[Burley 2012], an empirical formula after MERL's materials: smooth surfaces lose light at grazing
angles by the refraction into the ground, rough ones reflect it back towards the light. Of a white
surface, the albedo at normal incidence is 0.98 at r = 0 and 1.04 at r = 1; at 85° it is 0.67 and
1.40, so that rough surfaces conserve energy only where they are darker. Shows the ground of
plastics, paints and cloth; no gloss: "burley+ggx" has one.
"""

import drjit as dr

from brdfkit.core.geometry.vectors import cos_theta_d
from brdfkit.model import Model, shape, weight
from brdfkit.model.lobes import Cosine, Lobe
from brdfkit.model.microfacet import fifth_power

# The ball of its page: felt, brighter at its rim
PICTURE = {
    "diffuse_reflectance": [0.12, 0.35, 0.2],
    "roughness": 1.0,
}


class Burley(Model):
    diffuse_reflectance = weight(0.5, "k_d: albedo of the ground, about")
    roughness = shape(0.5, (0.0, 1.0), "r: roughness")

    def value(self, wi, wo):
        rise = 2 * self.roughness * dr.square(cos_theta_d(wi, wo)) - 0.5  # F₉₀ - 1
        entering, leaving = 1 + rise * fifth_power(1 - wi.z), 1 + rise * fifth_power(1 - wo.z)
        return entering * leaving / dr.pi

    def lobes(self):
        return (Lobe(self.value, Cosine(), diffuse=True),)
