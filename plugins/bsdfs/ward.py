"""Ward: a highlight with a Gaussian distribution of the surface's slopes, isotropic or elliptic.

    f = k_d / π + k_s exp[-tan²θ_h (cos²φ_h / α_u² + sin²φ_h / α_v²)]
                  / (4π α_u α_v √((N·L)(N·V)))

N, L and V are the normal and the directions of light and view, θ_h and φ_h the angle of the half
vector to N and its azimuth, α_u and α_v the widths along x and y. [Ward 1992]; [Kurt 2007, eqs.
3.6, 3.7]. It suits brushed metal and satin paint, and has no Fresnel effect and no
retro-reflection. At grazing angles the lobe loses energy up to about 88°, and gains it without
bound in the last degree: at α = 0.5 it reflects 0.38 k_s at 88° and 4.7 k_s at 89.99°.
"""

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitVector
from brdfkit.model import Model, follows, shape, weight
from brdfkit.model.lobes import HalfVector, Lobe, lambertian, make_factored_lobe
from brdfkit.model.microfacet import Beckmann, Visible

# The ball in the picture on the model's page: brushed steel
PICTURE = {
    "diffuse_reflectance": 0.03,
    "specular_reflectance": [0.5, 0.5, 0.52],
    "alpha_u": 0.35,
    "alpha_v": 0.08,
}


class Ward(Model):
    diffuse_reflectance = weight(0.4, "k_d: albedo of the diffuse term")
    specular_reflectance = weight(0.2, "k_s: strength of the highlight")
    alpha_u = shape(0.2, (0.001, 1.0), "α_u: width of the slopes along x", log=True, width=1)
    alpha_v = follows("alpha_u", alpha_u, "α_v: width of the slopes along y")

    def facet_factor(self, h: JitVector, cos_d: JitFloat) -> JitFloat:
        gauss = Beckmann(self.alpha_u, self.alpha_v).gauss(h)
        return gauss / (4 * dr.pi * self.alpha_u * self.alpha_v)

    def geometry_factor(self, wi: JitVector, wo: JitVector) -> JitFloat:
        return dr.rsqrt(wi.z * wo.z)

    def lobes(self) -> tuple[Lobe, ...]:
        sampling = HalfVector(Visible(Beckmann(self.alpha_u, self.alpha_v)))
        return lambertian(), make_factored_lobe(self.facet_factor, self.geometry_factor, sampling)
