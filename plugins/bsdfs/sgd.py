"""Shifted Gamma (SGD): a microfacet model whose slopes follow a power law that ends in a Gaussian.

    f = ρ_d / π + ρ_s / π · D G₁(N·L) G₁(N·V) F / ((N·L)(N·V))
    D = P₂₂(tan²θ_h) / (π cos⁴θ_h),   P₂₂(s) = K x^-p exp(-x) with x = α + s / α
    K = 1 / (α Γ(1 - p, α)), so that ∫ D cosθ_h dω = 1

N, L, V and H are the normal, the directions of light and view, and the half vector at the angle θ_h
to N; s = tan²θ_h is the squared slope of a facet. [Bagher et al. 2012]. The distribution D is flat
up to the slope α, a power law up to the slope √α and a Gaussian beyond; with p = 0 it is Beckmann's
of width √α. Smith's shadowing G₁ is integrated numerically; the paper approximates it within 2e-3
by 1 + λ (1 - exp(c (θ - θ₀)^k)), with four more numbers per material. The Fresnel reflectance F is
Schlick's, without the paper's further term -F₁ V·H, which can make F negative. The printed second
term is 4/π times D G F / 4(N·L)(N·V), the form in use today: energy is conserved for about ρ_d +
4/π ρ_s ≤ 1. It suits paints, plastics and metals, whose tails are longer than Beckmann's and
shorter than GGX's. It has no anisotropy and no retro-reflection. A fit takes twice as long as with
GGX.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import drjit as dr
import numpy as np

from brdfkit.core.array_types import JitFloat, JitVector
from brdfkit.model import shape, weight
from brdfkit.model.fresnel import FresnelModel
from brdfkit.model.lobes import HalfVector, Lobe, lambertian
from brdfkit.model.microfacet import Visible
from brdfkit.model.numerics import expm1, log1p

# Quadrature nodes and weights over slopes, up to where the density's Gaussian factor is exp(-END)
POINTS, GAUSS = np.polynomial.legendre.leggauss(12)
END = 10


@dataclass(frozen=True)
class ShiftedGamma:
    """A distribution of microfacet normals whose slopes follow a shifted Gamma distribution.

    A facet with the squared slope s has the density P₂₂ = (1 + s/α²)^-p exp(-s/α) / (α² I), where I
    is the integral that normalises it.
    """

    alpha: JitFloat
    p: JitFloat

    def D(self, h: JitVector) -> JitFloat:
        # Slopes beyond 1000 do not occur, but their derivatives would overflow single precision
        s = dr.minimum(_squared_slope(h), 1e6)
        power = dr.exp(-self.p * log1p(s / (self.alpha * self.alpha)) - s / self.alpha)
        I = sum(mass for _, mass in self._quadrature_nodes())
        return power * (1 + s) * (1 + s) / (dr.pi * self.alpha * self.alpha * I)

    def G1(self, w: JitVector) -> JitFloat:
        """Return Smith's shadowing 1 / (1 + Λ) of the direction `w` at the angle θ to the normal.

        Λ = ∫ P₂₂ (y - arctan y) / π ds over the squared slopes s with y² = s tan²θ - 1 > 0.
        """
        # Parameters become as wide as w, so that Dr.Jit sums derivatives over w once, not per node
        wide = dr.zeros(type(w.z), dr.width(w.z))
        slopes = ShiftedGamma(self.alpha + wide, self.p + wide)
        scale = self.alpha * self.alpha * _squared_slope(w)
        above, total = 0, 0
        for s, mass in slopes._quadrature_nodes():
            y = dr.sqrt(dr.maximum(s * scale - 1, 1e-6))
            above, total = above + mass * (y - dr.atan(y)), total + mass
        return 1 / (1 + above / (dr.pi * total))

    def _quadrature_nodes(self) -> Iterator[tuple[JitFloat, JitFloat]]:
        """Yield s/α² and a weight for each node of a quadrature over squared slopes s.

        The Gauss-Legendre nodes are spread in log(1 + s/α²), with s/α between 0 and END. The
        weights include P₂₂ without its normalisation, so that they add up to the integral I.
        """
        end = log1p(END / self.alpha)
        for point, gauss in zip(POINTS.tolist(), GAUSS.tolist(), strict=True):
            t = (point + 1) / 2 * end
            s = dr.exp(t) - 1
            yield s, gauss / 2 * end * dr.exp((1 - self.p) * t - self.alpha * s)

    def sample(self, wi: JitVector, u: JitVector) -> JitVector:
        """Draw a normal whose squared slope s has a density close to P₂₂.

        The density is the sum of a power law up to s = α and an exponential, equal at s = α.
        """
        share, q, end = self._power_law_share(), self._integral_exponent(), log1p(1 / self.alpha)
        near = expm1(log1p(u.x / share * expm1(q * end)) / q) * self.alpha * self.alpha
        far = -self.alpha * dr.log(dr.maximum((1 - u.x) / (1 - share), 1e-12))
        tangent = dr.sqrt(dr.select(u.x < share, near, far))
        cos_theta = dr.rsqrt(1 + tangent * tangent)
        sin_phi, cos_phi = dr.sincos(2 * dr.pi * u.y)
        sin_theta = tangent * cos_theta
        return type(wi)(sin_theta * cos_phi, sin_theta * sin_phi, cos_theta)

    def pdf(self, wi: JitVector, h: JitVector, cos_d: JitFloat) -> JitFloat:
        s, share, q = _squared_slope(h), self._power_law_share(), self._integral_exponent()
        alpha_2, end = self.alpha * self.alpha, log1p(1 / self.alpha)
        near = dr.exp((q - 1) * log1p(s / alpha_2)) * q / (alpha_2 * expm1(q * end))
        density = dr.select(s < self.alpha, share * near, 0)
        density += (1 - share) * dr.exp(-s / self.alpha) / self.alpha
        return density / (dr.pi * h.z * h.z * h.z)

    def _power_law_share(self) -> JitFloat:
        """Return the share of normals that `sample` draws by the power law, below s = α."""
        q, end = self._integral_exponent(), log1p(1 / self.alpha)
        near = self.alpha * expm1(q * end) / q
        return near / (near + dr.exp((q - 1) * end))

    def _integral_exponent(self) -> JitFloat:
        """Return the exponent 1 - p of the integral over the power law.

        Near 0, where the integral is a logarithm, the exponent is rounded to 0.001; the error is
        small enough for sampling.
        """
        q = 1 - self.p
        return dr.select(abs(q) < 1e-3, 1e-3, q)


def _squared_slope(w: JitVector) -> JitFloat:
    """Return the squared slope tan²θ of a direction at the angle θ to the normal."""
    return (w.x * w.x + w.y * w.y) / (w.z * w.z)


# The ball in the picture on the model's page: green car paint
PICTURE = {
    "diffuse_reflectance": [0.02, 0.1, 0.04],
    "specular_reflectance": [0.3, 0.6, 0.35],
    "alpha": 0.004,
    "p": 0.9,
    "f0": 0.3,
}


class SGD(FresnelModel):
    diffuse_reflectance = weight(0.4, "ρ_d: albedo of the diffuse term")
    specular_reflectance = weight(0.4, "ρ_s: strength of the highlight")
    alpha = shape(0.05, (1e-4, 1.0), "α: squared width of the slopes", log=True, width=1)
    p = shape(0.5, (0.0, 2.0), "p: fall of the power law between α and √α")
    f0 = shape(0.5, (0.0, 1.0), "F₀: Fresnel reflectance at normal incidence")

    def lobes(self) -> tuple[Lobe, ...]:
        slopes = ShiftedGamma(self.alpha, self.p)

        def geometry_factor(wi: JitVector, wo: JitVector) -> JitFloat:
            return slopes.G1(wi) * slopes.G1(wo) / (dr.pi * wi.z * wo.z)

        sampling = HalfVector(Visible(slopes))
        return lambertian(), *self.make_fresnel_lobes(
            slopes.D, geometry_factor, sampling, albedo=4 / dr.pi
        )
