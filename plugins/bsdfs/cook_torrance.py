"""Cook-Torrance: a microfacet model with Beckmann's distribution and V-groove shadowing.

    f = k_d / π + k_s / π · D G F / ((N·L)(N·V)),   D = exp[-(tanθ_h / m)²] / (m² cos⁴θ_h)

N, L and V are the normal and the directions of light and view, θ_h is the angle between N and the
half vector, m the rms slope of the facets, G the shadowing of V-grooves. [Cook & Torrance 1982];
[Kurt 2007, eqs. 3.28, 3.29], with Schlick's Fresnel reflectance F (eq. 3.16). The printed second
term is four times D G F / 4(N·L)(N·V), the form in use today: energy is conserved only for about
k_d + 4 k_s ≤ 1. It suits metals and plastics of one roughness, and has no anisotropy.
"""

from brdfkit.core.array_types import JitFloat, JitVector
from brdfkit.core.geometry.vectors import half_vector
from brdfkit.model import shape, weight
from brdfkit.model.fresnel import FresnelModel
from brdfkit.model.lobes import HalfVector, Lobe, lambertian
from brdfkit.model.microfacet import Beckmann, Visible, v_groove

# The ball in the picture on the model's page: cast bronze
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

    def geometry_factor(self, wi: JitVector, wo: JitVector) -> JitFloat:
        return v_groove(wi, wo, half_vector(wi, wo)) / (wi.z * wo.z)

    def lobes(self) -> tuple[Lobe, ...]:
        slopes = Beckmann(
            self.alpha, self.alpha
        )  # this distribution D includes the factor 1/π of eq. 3.28
        sampling = HalfVector(Visible(slopes))
        return lambertian(), *self.make_fresnel_lobes(
            slopes.D, self.geometry_factor, sampling, albedo=4
        )
