"""Cook-Torrance: Beckmann's facets in V-grooves, with Fresnel reflectance.

    f = k_d / π + k_s / π · D G F / ((N·L)(N·V)),   D = exp[-(tanθ_h / m)²] / (m² cos⁴θ_h)

[Cook & Torrance 1982]; [Kurt 2007, eqs. 3.28, 3.29], with Schlick's F (3.16). As printed, the term
is four times today's D G F / 4(N·L)(N·V): energy is conserved only for about k_d + 4 k_s ≤ 1. Shows
metals and plastics of one roughness; no anisotropy.
"""

from brdfkit.core.geometry.vectors import half_vector
from brdfkit.model import shape, weight
from brdfkit.model.fresnel import FresnelModel
from brdfkit.model.lobes import HalfVector, lambertian
from brdfkit.model.microfacet import Beckmann, Visible, v_groove

# The ball of its page: cast bronze
PICTURE = {
    "diffuse_reflectance": [0.06, 0.04, 0.02],
    "specular_reflectance": [0.35, 0.22, 0.1],
    "alpha": 0.3,
    "f0": 0.6,
}


class CookTorrance(FresnelModel):
    diffuse_reflectance = weight(0.4, "k_d: albedo of the diffuse term")
    specular_reflectance = weight(0.1, "k_s: strength of the highlight")
    alpha = shape(0.2, (0.001, 1.0), "m: rms slope of the facets", log=True, width=1)
    f0 = shape(0.5, (0.0, 1.0), "F₀: Fresnel reflectance at normal incidence")

    def geometry(self, wi, wo):
        return v_groove(wi, wo, half_vector(wi, wo)) / (wi.z * wo.z)

    def lobes(self):
        slopes = Beckmann(self.alpha, self.alpha)  # its D holds the 1/π of (3.28)
        sampling = HalfVector(Visible(slopes))
        return lambertian(), *self.fresnel_lobes(slopes.D, self.geometry, sampling, albedo=4)
