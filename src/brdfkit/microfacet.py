"""Distributions of microfacet normals, shadowing and Fresnel, shared by the models.

A distribution answers `D(h)` [sr⁻¹, ∫ D cosθ_h dω = 1], `sample(wi, u)` → h and `pdf(wi, h)`
per solid angle of h. `wi`, `h` are vectors with x, y, z in the local frame, z along the normal.
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr

# Directions this close to the horizon (cosine) count as below it: 1/cos stays finite in float32
HORIZON = 1e-6


def above_horizon(w, active):
    """The direction, or the normal where it is not above the surface, which turns inactive."""
    up = w.z > HORIZON
    return dr.select(up, w, type(w)(0, 0, 1)), active & up


def dot(a, b):
    """Scalar product."""
    return a.x * b.x + a.y * b.y + a.z * b.z


def half_vector(wi, wo):
    """Unit vector halfway between two directions above the surface."""
    s = wi + wo
    return s * dr.rsqrt(dot(s, s))


def reflect(wi, h):
    """Mirror image of `wi` about `h`."""
    return 2 * dot(wi, h) * h - wi


def schlick(f0, cos_theta):
    """Fresnel reflectance: C. Schlick, "An inexpensive BRDF model", 1994; Kurt 2007, eq. 3.16."""
    return f0 + (1 - f0) * fifth_power(1 - cos_theta)


def fifth_power(x):
    """x⁵ with an exact derivative at 0."""
    squared = x * x
    return squared * squared * x


def v_groove(wi, wo, h):
    """Shadowing and masking in V-grooves: Torrance & Sparrow 1967; Kurt 2007, eq. 3.27."""
    s = 2 * h.z / dot(wi, h)
    return dr.minimum(1, s * dr.minimum(wi.z, wo.z))


def _slope_exponent(h, alpha_u, alpha_v):
    # tan²θ_h (cos²φ_h/α_u² + sin²φ_h/α_v²), without a trigonometric function
    x, y = h.x / alpha_u, h.y / alpha_v
    return (x * x + y * y) / (h.z * h.z)


@dataclass(frozen=True)
class Beckmann:
    """Gaussian slopes of width `alpha_u` along x, `alpha_v` along y.

    P. Beckmann & A. Spizzichino 1963; sampling: Kurt 2007, eqs. 4.23-4.25.
    """

    alpha_u: Any
    alpha_v: Any

    def gauss(self, h):
        """exp(-tan²θ_h/α²), the part of D that Ward's models share."""
        return dr.exp(-_slope_exponent(h, self.alpha_u, self.alpha_v))

    def D(self, h):
        cos_2 = h.z * h.z
        return self.gauss(h) / (dr.pi * self.alpha_u * self.alpha_v * cos_2 * cos_2)

    def sample(self, wi, u):
        sin_phi, cos_phi = dr.sincos(2 * dr.pi * u.y)
        radius = dr.sqrt(-dr.log(dr.maximum(1 - u.x, 1e-12)))
        return _from_slope(
            type(wi), radius * self.alpha_u * cos_phi, radius * self.alpha_v * sin_phi
        )

    def pdf(self, wi, h):
        return self.D(h) * h.z


@dataclass(frozen=True)
class TrowbridgeReitz:
    """Slopes with long tails, of width `alpha_u` along x, `alpha_v` along y: "GGX".

    B. Walter et al. 2007; E. Heitz, "Understanding the masking-shadowing function", JCGT 2014.
    """

    alpha_u: Any
    alpha_v: Any

    def D(self, h):
        x, y = h.x / self.alpha_u, h.y / self.alpha_v
        s = x * x + y * y + h.z * h.z
        return 1 / (dr.pi * self.alpha_u * self.alpha_v * s * s)

    def Lambda(self, w):
        """Smith's auxiliary function (Heitz 2014, eq. 72)."""
        x, y = self.alpha_u * w.x, self.alpha_v * w.y
        return 0.5 * (dr.sqrt(1 + (x * x + y * y) / (w.z * w.z)) - 1)

    def G2(self, wi, wo):
        """Height-correlated shadowing and masking (Heitz 2014, eq. 99)."""
        return 1 / (1 + self.Lambda(wi) + self.Lambda(wo))

    def sample(self, wi, u):
        """Visible normals: J. Dupuy & A. Benyoub, "Sampling visible GGX normals with spherical
        caps", HPG 2023."""
        x, y = self.alpha_u * wi.x, self.alpha_v * wi.y
        inverse = dr.rsqrt(x * x + y * y + wi.z * wi.z)
        x, y, z = x * inverse, y * inverse, wi.z * inverse
        # a cap of the unit sphere, seen from the stretched direction
        cos_theta = (1 - u.y) * (1 + z) - z
        sin_theta = dr.sqrt(dr.maximum(1 - cos_theta * cos_theta, 0))
        sin_phi, cos_phi = dr.sincos(2 * dr.pi * u.x)
        x, y, z = x + sin_theta * cos_phi, y + sin_theta * sin_phi, z + cos_theta
        x, y, z = self.alpha_u * x, self.alpha_v * y, dr.maximum(z, 1e-7)
        inverse = dr.rsqrt(x * x + y * y + z * z)
        return type(wi)(x * inverse, y * inverse, z * inverse)

    def pdf(self, wi, h):
        G1 = 1 / (1 + self.Lambda(wi))
        return G1 * dr.maximum(dot(wi, h), 0) * self.D(h) / wi.z


@dataclass(frozen=True)
class CosinePower:
    """(N·H)^n, the lobe of Blinn-Phong. J. Blinn, SIGGRAPH 1977."""

    exponent: Any

    def D(self, h):
        return (self.exponent + 2) / (2 * dr.pi) * self._power(h)

    def sample(self, wi, u):
        # 1 - cosθ, of which cosθ in single precision knows too little
        complement = -expm1(dr.log(dr.maximum(1 - u.x, 1e-12)) / (self.exponent + 1))
        sin_theta = dr.sqrt(complement * (2 - complement))
        sin_phi, cos_phi = dr.sincos(2 * dr.pi * u.y)
        return type(wi)(sin_theta * cos_phi, sin_theta * sin_phi, 1 - complement)

    def pdf(self, wi, h):
        return (self.exponent + 1) / (2 * dr.pi) * self._power(h)

    def _power(self, h):
        return cosine_power((h.x * h.x + h.y * h.y) / (1 + h.z), self.exponent)


def cosine_power(complement, exponent):
    """cosine^exponent by `complement` = 1 - cosine, accurate for large exponents.

    0 where the cosine is not positive.
    """
    power = dr.exp(exponent * log1p(-dr.minimum(complement, 1 - 1e-6)))
    return dr.select(complement < 1, power, 0)


def log1p(x):
    """log(1 + x), accurate for small x: W. Kahan's way."""
    y = 1 + x
    return dr.select(y == 1, x, dr.log(y) * x / dr.select(y == 1, 1, y - 1))


def expm1(x):
    """exp(x) - 1, accurate for small x: W. Kahan's way."""
    y = dr.exp(x)
    log_y = dr.log(dr.maximum(y, 1e-30))
    return dr.select(y == 1, x, (y - 1) * x / dr.select(y == 1, 1, log_y))


def _from_slope(vector, x, y):
    inverse = dr.rsqrt(1 + x * x + y * y)
    return vector(x * inverse, y * inverse, inverse)
