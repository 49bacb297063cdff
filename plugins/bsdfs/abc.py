"""ABC: a microfacet model for smooth surfaces, whose distribution is a power law with a flat top.

    f = k_d / π + D G F / (π (N·L)(N·V)),   D = A / (1 + B (1 - N·H))^C

N, L, V and H are the normal, the directions of light and view, and the half vector. This is the
microfacet ABC model [Löw et al. 2012, eq. 15], with the factor 1/π of the fits that its authors
published. Its weight `specular_reflectance` is A. B sets the sharpness of the highlight, C the
steepness of its tails. The distribution D is not normalised: the albedo is roughly proportional to
A/B. F is the Fresnel reflectance of a dielectric in unpolarised light, as in the paper, and G the
shadowing of V-grooves, both in the form of [Cook & Torrance 1982]. With C = 2 the peak is close to
a GGX peak of width α = √(2/B). It suits polished metals, paints and plastics, whose highlights may
have longer or shorter tails than with GGX. It has no anisotropy and no retro-reflection.
"""

from dataclasses import dataclass

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitVector
from brdfkit.core.geometry.vectors import half_vector
from brdfkit.model import Model, shape, weight
from brdfkit.model.lobes import HalfVector, Lobe, lambertian, make_factored_lobe
from brdfkit.model.microfacet import Visible, v_groove
from brdfkit.model.numerics import expm1, log1p


@dataclass(frozen=True)
class PowerDistribution:
    """A distribution of microfacet normals with the density ∝ (1 + B (1 - cosθ_h))^-C.

    θ_h is the angle of a microfacet normal to the surface normal, B the sharpness of the highlight
    and C the steepness of its tails.
    """

    B: JitFloat
    C: JitFloat

    def power(self, h: JitVector) -> JitFloat:
        return dr.exp(-self.C * self._log_denominator(h))

    def sample(self, wi: JitVector, u: JitVector) -> JitVector:
        # Draws x = log(1 + B (1 - cosθ_h)) with a density proportional to exp(q x); cosθ_h follows
        q = self._integral_exponent()
        x = log1p(u.x * expm1(q * log1p(self.B))) / q
        complement = dr.minimum(expm1(x) / self.B, 1)
        sin_theta = dr.sqrt(complement * (2 - complement))
        sin_phi, cos_phi = dr.sincos(2 * dr.pi * u.y)
        return type(wi)(sin_theta * cos_phi, sin_theta * sin_phi, 1 - complement)

    def pdf(self, wi: JitVector, h: JitVector, cos_d: JitFloat) -> JitFloat:
        return (
            dr.exp((self._integral_exponent() - 1) * self._log_denominator(h))
            / self.integrate_power()
        )

    def integrate_power(self) -> JitFloat:
        """Return the integral of `power(h)` over the hemisphere, the normalisation of `pdf`."""
        q = self._integral_exponent()
        return 2 * dr.pi / self.B * expm1(q * log1p(self.B)) / q

    def _integral_exponent(self) -> JitFloat:
        """Return the exponent 1 - C of the integral over 1 + B (1 - cosθ_h).

        Near 0, where the integral is a logarithm, the exponent is rounded to 0.001; the error is
        small enough for sampling.
        """
        q = 1 - self.C
        return dr.select(abs(q) < 1e-3, 1e-3, q)

    def _log_denominator(self, h: JitVector) -> JitFloat:
        """Return log(1 + B (1 - cosθ_h)), accurate where h is close to the surface normal."""
        return log1p(self.B * (h.x * h.x + h.y * h.y) / (1 + h.z))


def fresnel(ior: JitFloat, cos_theta: JitFloat) -> JitFloat:
    """Return the Fresnel reflectance of a dielectric in unpolarised light [Cook & Torrance 1982].

    `ior` is the index of refraction, `cos_theta` the cosine of the angle of incidence.
    """
    g = dr.sqrt(ior * ior - 1 + cos_theta * cos_theta)
    a = (g - cos_theta) / (g + cos_theta)
    b = (cos_theta * (g + cos_theta) - 1) / (cos_theta * (g - cos_theta) + 1)
    return 0.5 * a * a * (1 + b * b)


# The ball in the picture on the model's page: a polished surface with some diffuse light
PICTURE = {
    "diffuse_reflectance": [0.1, 0.02, 0.14],
    "specular_reflectance": 300.0,
    "b": 20000.0,
    "c": 0.9,
}


class ABC(Model):
    diffuse_reflectance = weight(0.4, "k_d: albedo of the diffuse term")
    specular_reflectance = weight(60.0, "A: height of the highlight")
    b = shape(1000.0, (1.0, 1e7), "B: sharpness of the highlight", log=True, width=-0.5)
    c = shape(1.5, (0.05, 5.0), "C: steepness of its tails", log=True)
    ior = shape(1.5, (1.01, 100.0), "η: index of refraction", log=True)

    def geometry_factor(self, wi: JitVector, wo: JitVector) -> JitFloat:
        return v_groove(wi, wo, half_vector(wi, wo)) / (dr.pi * wi.z * wo.z)

    def lobes(self) -> tuple[Lobe, ...]:
        normals = PowerDistribution(self.b, self.c)

        def facet_factor(h: JitVector, cos_d: JitFloat) -> JitFloat:
            return normals.power(h) * fresnel(self.ior, cos_d)

        def energy(wi: JitVector) -> JitFloat:
            return 4 / dr.pi * normals.integrate_power() * fresnel(self.ior, wi.z)

        sampling = HalfVector(Visible(normals))
        return lambertian(), make_factored_lobe(
            facet_factor, self.geometry_factor, sampling, energy
        )
