"""Ward: a Gaussian of the surface slopes, isotropic or elliptic.

    f = k_d / π + k_s exp[-tan²θ_h (cos²φ_h / α_u² + sin²φ_h / α_v²)]
                  / (4π α_u α_v √((N·L)(N·V)))

[Ward 1992]; [Kurt 2007, eqs. 3.6, 3.7]. Shows brushed metal and satin paint; loses energy at
grazing angles down to about 88°, and gains it without bound in the last degree (at α = 0.5 the lobe
reflects 0.38 k_s at 88°, 4.7 k_s at 89.99°). It has no Fresnel effect and no retro-reflection.
"""

import drjit as dr

from brdfkit.model import Model, follows, shape, weight
from brdfkit.model.lobes import HalfVector, factored, lambertian
from brdfkit.model.microfacet import Beckmann, Visible

# The ball of its page: brushed steel
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

    def facets(self, h, cos_d):
        gauss = Beckmann(self.alpha_u, self.alpha_v).gauss(h)
        return gauss / (4 * dr.pi * self.alpha_u * self.alpha_v)

    def geometry(self, wi, wo):
        return dr.rsqrt(wi.z * wo.z)

    def lobes(self):
        sampling = HalfVector(Visible(Beckmann(self.alpha_u, self.alpha_v)))
        return lambertian(), factored(self.facets, self.geometry, sampling)
