"""Blinn-Phong: a power of the cosine between the normal and the half vector.

    f = k_d / π + k_s c (N·H)^(n_u cos²φ_h + n_v sin²φ_h)

    normalisation=printed   c = (n + 2) / 2π
    normalisation=exact     c = (n + 2)(n + 4) / (8π (2^(-n/2) + n))

N and H are the normal and the half vector, φ_h the azimuth of H. Where the exponents n_u and n_v
differ, n + 2 stands for √((n_u + 2)(n_v + 2)). [Blinn 1977]; [Kurt 2007, eq. 3.4]. The printed
constant is that of the Phong model. With the half vector the lobe reflects up to four times k_s, so
that energy is conserved only for about k_d + 4 k_s ≤ 1. With the exact constant, k_s is the albedo
of the lobe at normal incidence. It suits plastics, and has no Fresnel effect and no
retro-reflection.
"""

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitVector
from brdfkit.model import Model, follows, option, shape, weight
from brdfkit.model.lobes import HalfVector, Lobe, lambertian, make_factored_lobe
from brdfkit.model.microfacet import CosinePower, Visible

# The ball in the picture on the model's page: blue lacquer
PICTURE = {
    "diffuse_reflectance": [0.03, 0.08, 0.4],
    "specular_reflectance": 0.12,
    "exponent": 200.0,
}


class BlinnPhong(Model):
    normalisation = option("printed", ("printed", "exact"), "the constant c")
    diffuse_reflectance = weight(0.4, "k_d: albedo of the diffuse term")
    specular_reflectance = weight(0.1, "k_s: strength of the highlight")
    exponent = shape(
        30.0, (0.1, 1e4), "n_u: sharpness of the highlight, along x", log=True, width=-0.5
    )
    exponent_v = follows("exponent", exponent, "n_v: sharpness along y")

    def normalisation_constant(self) -> JitFloat:
        n = dr.sqrt((self.exponent + 2) * (self.exponent_v + 2)) - 2
        if self.normalisation == "printed":
            return (n + 2) / (2 * dr.pi)
        return (n + 2) * (n + 4) / (8 * dr.pi * (dr.exp(-n / 2 * dr.log(2.0)) + n))

    def facet_factor(self, h: JitVector, cos_d: JitFloat) -> JitFloat:
        return self.normalisation_constant() * CosinePower(self.exponent, self.exponent_v).power(h)

    def lobes(self) -> tuple[Lobe, ...]:
        sampling = HalfVector(Visible(CosinePower(self.exponent, self.exponent_v)))
        brightest = 4 if self.normalisation == "printed" else 1
        return lambertian(), make_factored_lobe(
            self.facet_factor, lambda wi, wo: 1.0, sampling, lambda wi: brightest * wi.z
        )
