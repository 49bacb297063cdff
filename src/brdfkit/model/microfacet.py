"""Distributions of microfacet normals, shadowing and Fresnel reflectance, which the models share.

A distribution has `D(h)` [sr⁻¹, ∫ D cosθ_h dω = 1], `sample(wi, u)`, which returns h, and `pdf(wi,
h, cos_d)`, the density of `sample` per solid angle of h. `wi` and the half vector `h` are unit
vectors with x, y, z in the local frame, z along the normal; `u` is a point (x, y, z) of the unit
cube; cos_d = wi·h, as `cos_theta_d` computes it.
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitVector
from brdfkit.core.geometry.vectors import cos_theta_d, dot
from brdfkit.model.numerics import cosine_power, expm1


def schlick(f0: JitFloat, cos_theta: JitFloat) -> JitFloat:
    """Return the Fresnel reflectance for F₀ = `f0` [Schlick 1994]; [Kurt 2007, eq. 3.16]."""
    return f0 + (1 - f0) * fifth_power(1 - cos_theta)


def fifth_power(x: JitFloat) -> JitFloat:
    """Return x⁵ with an exact derivative at 0."""
    squared = x * x
    return squared * squared * x


def v_groove(wi: JitVector, wo: JitVector, h: JitVector) -> JitFloat:
    """Return the masking of V-grooves [Torrance & Sparrow 1967]; [Kurt 2007, eq. 3.27]."""
    s = 2 * h.z / cos_theta_d(wi, wo)
    return dr.minimum(1, s * dr.minimum(wi.z, wo.z))


def _slope_exponent(h: JitVector, alpha_u: JitFloat, alpha_v: JitFloat) -> JitFloat:
    """Return tan²θ_h (cos²φ_h/α_u² + sin²φ_h/α_v²), without a trigonometric function."""
    x, y = h.x / alpha_u, h.y / alpha_v
    return (x * x + y * y) / cos_squared(h)


def cos_squared(h: JitVector) -> JitFloat:
    """Return cos²θ_h, at least 1e-6, so that D and its derivatives stay finite."""
    return dr.maximum(h.z * h.z, 1e-6)


@dataclass(frozen=True)
class Beckmann:
    """Normals with Gaussian slopes, of width `alpha_u` along x and `alpha_v` along y.

    [Beckmann & Spizzichino 1963]; sampling: [Kurt 2007, eqs. 4.23-4.25].
    """

    alpha_u: Any
    alpha_v: Any

    def gauss(self, h: JitVector) -> JitFloat:
        """Return exp(-tan²θ_h/α²), the part of D that Ward's models share."""
        return dr.exp(-_slope_exponent(h, self.alpha_u, self.alpha_v))

    def D(self, h: JitVector) -> JitFloat:
        cos_2 = cos_squared(h)
        return self.gauss(h) / (dr.pi * self.alpha_u * self.alpha_v * cos_2 * cos_2)

    def sample(self, wi: JitVector, u: JitVector) -> JitVector:
        sin_phi, cos_phi = dr.sincos(2 * dr.pi * u.y)
        radius = dr.sqrt(-dr.log(dr.maximum(1 - u.x, 1e-12)))
        return _slope_normal(
            type(wi), radius * self.alpha_u * cos_phi, radius * self.alpha_v * sin_phi
        )

    def pdf(self, wi: JitVector, h: JitVector, cos_d: JitFloat) -> JitFloat:
        return self.D(h) * h.z


@dataclass(frozen=True)
class TrowbridgeReitz:
    """GGX, normals with long-tailed slopes, of width `alpha_u` along x and `alpha_v` along y.

    [Walter et al. 2007]; [Heitz 2014]
    """

    alpha_u: Any
    alpha_v: Any

    def D(self, h: JitVector) -> JitFloat:
        x, y = h.x / self.alpha_u, h.y / self.alpha_v
        s = x * x + y * y + h.z * h.z
        return 1 / (dr.pi * self.alpha_u * self.alpha_v * s * s)

    def Lambda(self, w: JitVector) -> JitFloat:
        """Return Smith's auxiliary function [Heitz 2014, eq. 72]."""
        x, y = self.alpha_u * w.x, self.alpha_v * w.y
        return 0.5 * (dr.sqrt(1 + (x * x + y * y) / (w.z * w.z)) - 1)

    def G2(self, wi: JitVector, wo: JitVector) -> JitFloat:
        """Return the height-correlated shadowing and masking [Heitz 2014, eq. 99]."""
        return 1 / (1 + self.Lambda(wi) + self.Lambda(wo))

    def sample(self, wi: JitVector, u: JitVector) -> JitVector:
        """Draw a visible normal by spherical caps [Dupuy & Benyoub 2023]."""
        # Stretch wi so that the visible normals become those of a hemisphere
        x, y = self.alpha_u * wi.x, self.alpha_v * wi.y
        inverse = dr.rsqrt(x * x + y * y + wi.z * wi.z)
        x, y, z = x * inverse, y * inverse, wi.z * inverse
        # The mirror direction is uniform in a spherical cap; the sum of both is along the normal
        cos_theta = (1 - u.y) * (1 + z) - z
        sin_theta = dr.sqrt(dr.maximum(1 - cos_theta * cos_theta, 0))
        sin_phi, cos_phi = dr.sincos(2 * dr.pi * u.x)
        x, y, z = x + sin_theta * cos_phi, y + sin_theta * sin_phi, z + cos_theta
        # Stretch the normal back
        x, y, z = self.alpha_u * x, self.alpha_v * y, dr.maximum(z, 1e-7)
        inverse = dr.rsqrt(x * x + y * y + z * z)
        return type(wi)(x * inverse, y * inverse, z * inverse)

    def pdf(self, wi: JitVector, h: JitVector, cos_d: JitFloat) -> JitFloat:
        G1 = 1 / (1 + self.Lambda(wi))
        return G1 * cos_d * self.D(h) / wi.z


@dataclass(frozen=True)
class CosinePower:
    """A distribution of normals in proportion to (N·H)^(n_u cos²φ_h + n_v sin²φ_h).

    [Blinn 1977]; [Ashikhmin & Shirley 2000]
    """

    n_u: Any
    n_v: Any

    def power(self, h: JitVector) -> JitFloat:
        """Return (N·H)^(n_u cos²φ_h + n_v sin²φ_h)."""
        x, y = h.x * h.x, h.y * h.y
        exponent = (self.n_u * x + self.n_v * y) / dr.maximum(x + y, 1e-20)
        return cosine_power((x + y) / (1 + h.z), exponent)

    def sample(self, wi: JitVector, u: JitVector) -> JitVector:
        sin_phi, cos_phi = dr.sincos(2 * dr.pi * u.y)
        x, y = cos_phi * dr.sqrt(self.n_v + 1), sin_phi * dr.sqrt(self.n_u + 1)
        inverse = dr.rsqrt(x * x + y * y)
        x, y = x * inverse, y * inverse
        exponent = self.n_u * x * x + self.n_v * y * y
        # 1 - cosθ_h, computed without the cosine, which loses its digits in single precision
        complement = -expm1(dr.log(dr.maximum(1 - u.x, 1e-12)) / (exponent + 1))
        sin_theta = dr.sqrt(complement * (2 - complement))
        return type(wi)(sin_theta * x, sin_theta * y, 1 - complement)

    def density(self, h: JitVector) -> JitFloat:
        return dr.sqrt((self.n_u + 1) * (self.n_v + 1)) / (2 * dr.pi) * self.power(h)

    def pdf(self, wi: JitVector, h: JitVector, cos_d: JitFloat) -> JitFloat:
        return self.density(h)


@dataclass(frozen=True)
class Visible:
    """The normals of a `distribution` that are visible from wi on a surface of V-grooves.

    The two facets of a groove have the normal h and its mirror image about the surface normal. One
    of them is drawn in proportion to its area as it appears from wi. The `distribution` should be
    the same after a half turn about the surface normal.

    The density is G1 (wi·h)⁺ D / cosθ_i [Heitz & d'Eon 2014], with the G1 of `v_groove`.
    """

    distribution: Any

    def sample(self, wi: JitVector, u: JitVector) -> JitVector:
        h = self.distribution.sample(wi, u)
        other = type(wi)(-h.x, -h.y, h.z)
        area, other_area = dr.maximum(dot(wi, h), 0), dr.maximum(dot(wi, other), 0)
        return dr.select(u.z * (area + other_area) < area, h, other)

    def pdf(self, wi: JitVector, h: JitVector, cos_d: JitFloat) -> JitFloat:
        area = cos_d / (h.z * wi.z)
        return self.distribution.pdf(wi, h, cos_d) * dr.minimum(area, 2)


def _slope_normal(vector: Any, x: JitFloat, y: JitFloat) -> JitVector:
    """Return the unit normal of a facet with the slopes `x` and `y`, as the type `vector`."""
    inverse = dr.rsqrt(1 + x * x + y * y)
    return vector(x * inverse, y * inverse, inverse)
