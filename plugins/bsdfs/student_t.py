"""Student's t: a microfacet model with adjustable tails, from longer than GGX's to Beckmann's.

    f = k_d / π + k_s D G₂ F / (4 (N·L)(N·V))
    D = 1 / (π α² cos⁴θ_h) [1 + tan²θ_h / ((γ - 1) α²)]^-γ

N, L and V are the normal and the directions of light and view, θ_h and φ_h the angle of the half
vector to N and its azimuth. This is the distribution STD of [Ribardière et al. 2017]: slopes follow
Student's t-distribution of width α with 2γ - 2 degrees of freedom. γ = 2 is GGX, γ → ∞ Beckmann. G₂
is Smith's height-correlated shadowing [Heitz 2014]. The paper approximates G₂ by fitted rational
functions; the approximation here has a G₁ within 2e-4 of the integral for every α, γ and direction,
and is exact at γ = 2. F is Schlick's Fresnel reflectance. Where the widths along x and y differ,
tan²θ_h (cos²φ_h / α_u² + sin²φ_h / α_v²) takes the place of tan²θ_h / α². It suits metals, paints
and plastics, polished or rough, brushed or not. It has no retro-reflection and no scattering
between facets. Measurements of a broad highlight hardly distinguish α from γ.
"""

from dataclasses import dataclass

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitVector
from brdfkit.model import follows, shape, weight
from brdfkit.model.fresnel import FresnelModel
from brdfkit.model.lobes import HalfVector, Lobe, lambertian
from brdfkit.model.microfacet import Visible
from brdfkit.model.numerics import expm1, log1p


@dataclass(frozen=True)
class StudentSlopes:
    """A distribution of microfacet normals whose slopes follow Student's t-distribution.

    `alpha_u` and `alpha_v` are the widths of the slopes along x and y, `gamma` is the exponent γ of
    the tails.
    """

    alpha_u: JitFloat
    alpha_v: JitFloat
    gamma: JitFloat

    def D(self, h: JitVector) -> JitFloat:
        x, y, cos_2 = h.x / self.alpha_u, h.y / self.alpha_v, dr.maximum(h.z * h.z, 1e-12)
        # s is the bracket of the formula for D times cos²θ_h; it is finite and above 0 everywhere
        s = cos_2 + (x * x + y * y) / (self.gamma - 1)
        power = dr.exp((self.gamma - 2) * dr.log(cos_2) - self.gamma * dr.log(s))
        return power / (dr.pi * self.alpha_u * self.alpha_v)

    def Lambda(self, w: JitVector) -> JitFloat:
        """Return Smith's auxiliary function Λ, which determines the shadowing, at a direction `w`.

        It is ∫ (t - cotθ)⁺ P(t) dt / cotθ, where t is the slope of a facet towards w, P the
        one-dimensional density of t, θ the angle of w to the normal, and (x)⁺ = max(x, 0). With
        a = √(γ - 1) α tanθ, v² = 1 / (1 + a²), z² = 1 - v², n = 2γ - 3 and
        c = Γ(γ - 1/2) / (√π Γ(γ - 1)), integration by parts gives

            Λ = a zⁿ c/n (1 - n v / W),   1/W = z^(-n-1) ∫ zⁿ dz / √(1 - z²) from 0 to z.

        The integral 1/W is approximated by W = A v + √(4c² + B v + C v²). B and C are chosen such
        that W has its true value 2c and slope 4c² at v = 0 (grazing), and its true value n + 1 at
        v = 1. A is a linear function of n that keeps the error of G₁ within 2e-4.
        """
        n, c_2 = 2 * self.gamma - 3, self._double_c()
        x, y = self.alpha_u * w.x, self.alpha_v * w.y
        a_2 = dr.maximum((self.gamma - 1) * (x * x + y * y) / (w.z * w.z), 1e-14)
        v_2 = 1 / (1 + a_2)
        v, k = dr.sqrt(v_2), 0.4 + 0.05 * n
        A, B = c_2 * c_2 - k, 2 * c_2 * k
        C = dr.square(n + 1 - A) - c_2 * c_2 - B
        W = A * v + dr.sqrt(c_2 * c_2 + v * (B + C * v))
        a_z_n = dr.sqrt(a_2) * dr.exp(0.5 * n * dr.log(a_2 * v_2))
        return 0.5 * a_z_n * c_2 * (1 / n - v / W)

    def _double_c(self) -> JitFloat:
        """Return the constant 2c = 2 Γ(γ - 1/2) / (√π Γ(γ - 1)) of `Lambda`.

        Brouncker's continued fraction gives it at γ + 1, where the fraction converges faster, and
        the recurrence of Γ leads back to γ.
        """
        x = self.gamma - 1
        s = 8 * x + 6
        gammas = (s + 2 / (s + 9 / (s + 25 / (s + 49 / s)))) / 8
        return 2 / dr.sqrt(dr.pi) * x / (x + 0.5) * dr.sqrt(gammas)

    def G2(self, wi: JitVector, wo: JitVector) -> JitFloat:
        """Return Smith's height-correlated shadowing and masking [Heitz 2014, eq. 99]."""
        return 1 / (1 + self.Lambda(wi) + self.Lambda(wo))

    def sample(self, wi: JitVector, u: JitVector) -> JitVector:
        x = self.gamma - 1
        tangent = dr.sqrt(x * expm1(-log1p(-u.x) / x))
        sin_phi, cos_phi = dr.sincos(2 * dr.pi * u.y)
        x, y = tangent * self.alpha_u * cos_phi, tangent * self.alpha_v * sin_phi
        inverse = dr.rsqrt(1 + x * x + y * y)
        return type(wi)(x * inverse, y * inverse, inverse)

    def pdf(self, wi: JitVector, h: JitVector, cos_d: JitFloat) -> JitFloat:
        return self.D(h) * h.z


# The ball in the picture on the model's page: a coat with tails longer than GGX's
PICTURE = {
    "diffuse_reflectance": [0.02, 0.02, 0.03],
    "specular_reflectance": [0.8, 0.85, 0.95],
    "alpha_u": 0.05,
    "gamma": 1.6,
    "f0": 0.9,
}


class StudentT(FresnelModel):
    diffuse_reflectance = weight(0.4, "k_d: albedo of the diffuse term")
    specular_reflectance = weight(0.5, "k_s: strength of the highlight")
    alpha_u = shape(0.2, (0.001, 1.0), "α_u: width of the slopes along x", log=True, width=1)
    alpha_v = follows("alpha_u", alpha_u, "α_v: width of the slopes along y")
    gamma = shape(3.0, (1.51, 40.0), "γ: fall of the tails", log=True)
    f0 = shape(0.5, (0.0, 1.0), "F₀: Fresnel reflectance at normal incidence")

    def lobes(self) -> tuple[Lobe, ...]:
        slopes = StudentSlopes(self.alpha_u, self.alpha_v, self.gamma)

        def geometry_factor(wi: JitVector, wo: JitVector) -> JitFloat:
            return slopes.G2(wi, wo) / (4 * wi.z * wo.z)

        sampling = HalfVector(Visible(slopes))
        return lambertian(), *self.make_fresnel_lobes(slopes.D, geometry_factor, sampling)
