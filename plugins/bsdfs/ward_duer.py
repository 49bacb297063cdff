"""Ward-Dür: Ward's model with a stronger mirror peak towards grazing angles.

    f = k_d / π + k_s exp[-tan²θ_h (cos²φ_h / α_u² + sin²φ_h / α_v²)]
                  / (4π α_u α_v (N·L)(N·V))

A. Dür, "An improved normalization for the Ward reflectance model", JGT 11(1), 2006; Kurt 2007,
eqs. 3.8, 3.9. Fits better than Ward; beyond about 80° its albedo grows without bound.
"""

import drjit as dr

from brdfkit.lobes import HalfVector, Lobe, lambertian
from brdfkit.microfacet import Beckmann, half_vector
from brdfkit.model import Model, follows, shape, weight


class WardDuer(Model):
    diffuse_reflectance = weight(0.4, "k_d: albedo of the diffuse term")
    specular_reflectance = weight(0.2, "k_s: strength of the highlight")
    alpha_u = shape(0.2, (0.001, 1.0), "α_u: width of the slopes along x", log=True)
    alpha_v = follows("alpha_u", alpha_u, "α_v: width of the slopes along y")

    def specular(self, wi, wo):
        gauss = Beckmann(self.alpha_u, self.alpha_v).gauss(half_vector(wi, wo))
        return gauss / (4 * dr.pi * self.alpha_u * self.alpha_v * wi.z * wo.z)

    def lobes(self):
        sampling = HalfVector(Beckmann(self.alpha_u, self.alpha_v))
        return lambertian(), Lobe(self.specular, sampling)
