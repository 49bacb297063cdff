"""Ashikhmin-Shirley: a microfacet model with a Phong-like distribution, isotropic or elliptic.

    f = f_d + k_s √((n_u + 1)(n_v + 1)) / 8π (N·H)^(n_u cos²φ_h + n_v sin²φ_h) F
              / ((V·H) max(N·L, N·V)),     F = F₀ + (1 - F₀)(1 - V·H)⁵

    diffuse=lambert   f_d = k_d / π
    diffuse=coupled   f_d = 28 k_d / 23π (1 - F₀) (1 - (1 - N·L/2)⁵) (1 - (1 - N·V/2)⁵)

N, L, V and H are the normal, the directions of light and view, and the half vector, φ_h its
azimuth. n_u and n_v are the exponents along x and y, F₀ is the reflectance at normal incidence.
[Ashikhmin & Shirley 2000]; [Kurt 2007, eqs. 3.13-3.17]. The paper has the coupled f_d, which
becomes darker where the highlight becomes brighter, and no k_s. With fresnel=coloured, k_d includes
the factor 1 - F₀ of f_d. It suits metals, brushed or not, and varnished surfaces, and has no
retro-reflection. Where F₀ is about 1, measurements determine only the product k_s F₀.
"""

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitVector
from brdfkit.core.geometry.vectors import cos_theta_d
from brdfkit.model import follows, option, shape, weight
from brdfkit.model.fresnel import FresnelModel
from brdfkit.model.lobes import Cosine, HalfVector, Lobe, lambertian
from brdfkit.model.microfacet import CosinePower, Visible, fifth_power

# The ball in the picture on the model's page: brushed copper
PICTURE = {
    "diffuse_reflectance": 0.02,
    "specular_reflectance": [0.95, 0.64, 0.54],
    "exponent_u": 15.0,
    "exponent_v": 400.0,
    "f0": 0.9,
}


class AshikhminShirley(FresnelModel):
    diffuse = option("lambert", ("lambert", "coupled"), "form of the diffuse term")
    diffuse_reflectance = weight(0.4, "k_d: albedo of the diffuse term")
    specular_reflectance = weight(0.5, "k_s: strength of the highlight")
    exponent_u = shape(
        100.0, (1e-4, 1e4), "n_u: sharpness of the highlight along x", log=True, width=-0.5
    )
    exponent_v = follows("exponent_u", exponent_u, "n_v: sharpness of the highlight along y")
    f0 = shape(0.5, (0.0, 1.0), "F₀: Fresnel reflectance at normal incidence")

    def coupled_diffuse(self, wi: JitVector, wo: JitVector) -> JitFloat:
        return (
            28
            / (23 * dr.pi)
            * self.unreflected_share()
            * entering_share(wi.z)
            * entering_share(wo.z)
        )

    def coupled_albedo(self, wi: JitVector) -> JitFloat:
        return self.unreflected_share() * entering_share(wi.z)

    def unreflected_share(self) -> JitFloat:
        """Return the diffuse term's factor 1 - F₀, or 1 if F is coloured: k_d then includes it."""
        return 1 - self.f0 if self.fresnel == "schlick" else 1

    def geometry_factor(self, wi: JitVector, wo: JitVector) -> JitFloat:
        return 1 / (4 * cos_theta_d(wi, wo) * dr.maximum(wi.z, wo.z))

    def lobes(self) -> tuple[Lobe, ...]:
        powers = CosinePower(self.exponent_u, self.exponent_v)
        diffuse = lambertian()
        if self.diffuse == "coupled":
            diffuse = Lobe(self.coupled_diffuse, Cosine(), self.coupled_albedo, diffuse=True)
        sampling = HalfVector(Visible(powers))
        return diffuse, *self.make_fresnel_lobes(powers.density, self.geometry_factor, sampling)


def entering_share(cosine: JitFloat) -> JitFloat:
    """Return the share of light that enters the base layer at an angle with this `cosine`."""
    return 1 - fifth_power(1 - cosine / 2)
