"""Blinn-Phong: a power of the cosine between the normal and the half vector.

    f = k_d / π + k_s (n + 2) / 2π (N·H)^n

J. F. Blinn, "Models of light reflection for computer synthesized pictures", SIGGRAPH 1977;
Kurt 2007, eq. 3.4. The constant is Phong's, as printed there: with the half vector the lobe
reflects up to four times k_s, so that energy is conserved only for about k_d + 4 k_s ≤ 1.
Shows plastics; no Fresnel effect, no retro-reflection.
"""

from brdfkit.lobes import HalfVector, Lobe, lambertian
from brdfkit.microfacet import CosinePower, half_vector
from brdfkit.model import Model, shape, weight


class BlinnPhong(Model):
    diffuse_reflectance = weight(0.4, "k_d: albedo of the diffuse term")
    specular_reflectance = weight(0.1, "k_s: strength of the highlight")
    exponent = shape(30.0, (0.1, 1e4), "n: sharpness of the highlight", log=True)

    def specular(self, wi, wo):
        return CosinePower(self.exponent).D(half_vector(wi, wo))

    def lobes(self):
        sampling = HalfVector(CosinePower(self.exponent))
        return lambertian(), Lobe(self.specular, sampling, lambda wi: 4 * wi.z)
