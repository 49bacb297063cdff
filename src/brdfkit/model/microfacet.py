"""Distributions of microfacet normals, shadowing and Fresnel reflectance, shared by the models.

A distribution has three methods: `D(h)` [sr⁻¹], with ∫ D cosθ_h dω = 1, where θ_h is the angle of h
to the surface normal; `sample(wi, u)`, which draws h by a point `u` (x, y, z) of the unit cube; and
`pdf(wi, h, cos_d)`, the density of `sample` per solid angle of h, with cos_d = wi·h. `wi` and the
half vector `h` are unit vectors in the local frame, whose z axis is the surface normal.
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitVector
from brdfkit.core.geometry.vectors import cos_theta_d, dot, half_vector
from brdfkit.model.numerics import cosine_power, expm1


def schlick(f0: JitFloat, cos_theta: JitFloat) -> JitFloat:
    """Return the Fresnel reflectance of a facet, which is `f0` at normal incidence.

    `cos_theta` is the cosine of the angle of incidence. [Schlick 1994]; [Kurt 2007, eq. 3.16]
    """
    return f0 + (1 - f0) * fifth_power(1 - cos_theta)


def grazing_share(wi: JitVector, wo: JitVector) -> JitFloat:
    """Return (1 - V·H)⁵, the share of F₉₀ in the Fresnel reflectance of a facet [Schlick 1994]."""
    return fifth_power(1 - cos_theta_d(wi, wo))


def pass_layer(entering: JitFloat, leaving: JitFloat) -> JitFloat:
    """Return the share of light that a layer lets pass, from its albedos of both directions.

    It is the geometric mean of both shares, which is reciprocal, unlike the share of one direction.
    """
    return dr.sqrt(dr.maximum((1 - entering) * (1 - leaving), 1e-12))


def reflectance_from_ior(ior: JitFloat) -> JitFloat:
    """Return Fresnel's reflectance at normal incidence for an index of refraction."""
    return dr.square((ior - 1) / (ior + 1))


def dielectric_reflectance(cosine: JitFloat, ior: JitFloat) -> JitFloat:
    """Return Fresnel's reflectance of a dielectric for unpolarised light from the air outside.

    `cosine` is that of the angle of incidence, `ior` the index of refraction, at least 1.
    """
    # g is the index times the cosine inside; at grazing angles g ≥ √(ior² - 1), 0 at ior = 1
    g = dr.sqrt(dr.maximum(ior * ior - 1 + cosine * cosine, 1e-12))
    parallel = (ior * ior * cosine - g) / (ior * ior * cosine + g)
    perpendicular = (cosine - g) / (cosine + g)
    return 0.5 * (parallel * parallel + perpendicular * perpendicular)


def fifth_power(x: JitFloat) -> JitFloat:
    """Return x⁵, by multiplications, so that the derivative at 0 is exact."""
    squared = x * x
    return squared * squared * x


def v_groove(wi: JitVector, wo: JitVector, h: JitVector) -> JitFloat:
    """Return the shadowing and masking of V-grooves, 0 to 1, for facets with the normal `h`.

    [Torrance & Sparrow 1967]; [Kurt 2007, eq. 3.27]
    """
    s = 2 * h.z / cos_theta_d(wi, wo)
    return dr.minimum(1, s * dr.minimum(wi.z, wo.z))


def _scaled_slope_squared(h: JitVector, alpha_u: JitFloat, alpha_v: JitFloat) -> JitFloat:
    """Return the squared slope of a facet with the normal h, tan²θ_h (cos²φ_h/α_u² + sin²φ_h/α_v²).

    The slopes along x and y are divided by the widths α_u and α_v of their distribution.
    θ_h and φ_h are the angle of h to the surface normal and its azimuth.
    """
    x, y = h.x / alpha_u, h.y / alpha_v
    return (x * x + y * y) / cos_squared(h)


def cos_squared(h: JitVector) -> JitFloat:
    """Return the squared cosine of h to the normal, at least 1e-6, so that 1 / cos² is finite."""
    return dr.maximum(h.z * h.z, 1e-6)


@dataclass(frozen=True)
class Beckmann:
    """Beckmann's distribution: normals with Gaussian slopes of widths `alpha_u` and `alpha_v`.

    The widths are along x and y.

    [Beckmann & Spizzichino 1963]; sampling: [Kurt 2007, eqs. 4.23-4.25].
    """

    alpha_u: Any
    alpha_v: Any

    def gauss(self, h: JitVector) -> JitFloat:
        """Return the Gaussian factor of D, exp(-tan²θ_h/α²) with the angle θ_h of h to the normal.

        Ward's models use it without the other factors of D.
        """
        return dr.exp(-_scaled_slope_squared(h, self.alpha_u, self.alpha_v))

    def D(self, h: JitVector) -> JitFloat:
        cos_2 = cos_squared(h)
        return self.gauss(h) / (dr.pi * self.alpha_u * self.alpha_v * cos_2 * cos_2)

    def sample(self, wi: JitVector, u: JitVector) -> JitVector:
        sin_phi, cos_phi = dr.sincos(2 * dr.pi * u.y)
        radius = dr.sqrt(-dr.log(dr.maximum(1 - u.x, 1e-12)))
        return _normal_from_slopes(
            type(wi), radius * self.alpha_u * cos_phi, radius * self.alpha_v * sin_phi
        )

    def pdf(self, wi: JitVector, h: JitVector, cos_d: JitFloat) -> JitFloat:
        return self.D(h) * h.z


@dataclass(frozen=True)
class TrowbridgeReitz:
    """The distribution of GGX: normals with long-tailed slopes of widths `alpha_u` and `alpha_v`.

    The widths are along x and y.
    [Walter et al. 2007]; [Heitz 2014]
    """

    alpha_u: Any
    alpha_v: Any

    def D(self, h: JitVector) -> JitFloat:
        x, y = h.x / self.alpha_u, h.y / self.alpha_v
        s = x * x + y * y + h.z * h.z
        return 1 / (dr.pi * self.alpha_u * self.alpha_v * s * s)

    def Lambda(self, w: JitVector) -> JitFloat:
        """Return Smith's auxiliary function Λ, which gives the shadowing [Heitz 2014, eq. 72]."""
        x, y = self.alpha_u * w.x, self.alpha_v * w.y
        return 0.5 * (dr.sqrt(1 + (x * x + y * y) / (w.z * w.z)) - 1)

    def G1(self, w: JitVector) -> JitFloat:
        """Return Smith's shadowing or masking of one direction [Heitz 2014, eq. 43]."""
        return 1 / (1 + self.Lambda(w))

    def G2(self, wi: JitVector, wo: JitVector) -> JitFloat:
        """Return Smith's height-correlated shadowing and masking [Heitz 2014, eq. 99]."""
        return 1 / (1 + self.Lambda(wi) + self.Lambda(wo))

    def sample(self, wi: JitVector, u: JitVector) -> JitVector:
        """Draw a normal among those visible from wi, by spherical caps [Dupuy & Benyoub 2023]."""
        # Stretch the surface so that its visible normals become those of a hemisphere
        x, y = self.alpha_u * wi.x, self.alpha_v * wi.y
        inverse = dr.rsqrt(x * x + y * y + wi.z * wi.z)
        x, y, z = x * inverse, y * inverse, wi.z * inverse
        # The direction into which the normal reflects wi is uniform in a spherical cap. The sum of
        # wi and this direction is along the normal
        cos_theta = (1 - u.y) * (1 + z) - z
        sin_theta = dr.sqrt(dr.maximum(1 - cos_theta * cos_theta, 0))
        sin_phi, cos_phi = dr.sincos(2 * dr.pi * u.x)
        x, y, z = x + sin_theta * cos_phi, y + sin_theta * sin_phi, z + cos_theta
        # Undo the stretching, for the normal
        x, y, z = self.alpha_u * x, self.alpha_v * y, dr.maximum(z, 1e-7)
        inverse = dr.rsqrt(x * x + y * y + z * z)
        return type(wi)(x * inverse, y * inverse, z * inverse)

    def pdf(self, wi: JitVector, h: JitVector, cos_d: JitFloat) -> JitFloat:
        return self.G1(wi) * cos_d * self.D(h) / wi.z


@dataclass(frozen=True)
class CosinePower:
    """A distribution of normals h in proportion to (N·H)^(n_u cos²φ_h + n_v sin²φ_h).

    N·H is the cosine of h to the surface normal, φ_h the azimuth of h. [Blinn 1977];
    [Ashikhmin & Shirley 2000]
    """

    n_u: Any
    n_v: Any

    def power(self, h: JitVector) -> JitFloat:
        """Return (N·H)^(n_u cos²φ_h + n_v sin²φ_h), where φ_h is the azimuth of the normal h."""
        x, y = h.x * h.x, h.y * h.y
        exponent = (self.n_u * x + self.n_v * y) / dr.maximum(x + y, 1e-20)
        return cosine_power((x + y) / (1 + h.z), exponent)

    def sample(self, wi: JitVector, u: JitVector) -> JitVector:
        sin_phi, cos_phi = dr.sincos(2 * dr.pi * u.y)
        x, y = cos_phi * dr.sqrt(self.n_v + 1), sin_phi * dr.sqrt(self.n_u + 1)
        inverse = dr.rsqrt(x * x + y * y)
        x, y = x * inverse, y * inverse
        exponent = self.n_u * x * x + self.n_v * y * y
        # 1 - cosθ_h, computed without the cosine, from which single precision would lose digits
        complement = -expm1(dr.log(dr.maximum(1 - u.x, 1e-12)) / (exponent + 1))
        sin_theta = dr.sqrt(complement * (2 - complement))
        return type(wi)(sin_theta * x, sin_theta * y, 1 - complement)

    def density(self, h: JitVector) -> JitFloat:
        return dr.sqrt((self.n_u + 1) * (self.n_v + 1)) / (2 * dr.pi) * self.power(h)

    def pdf(self, wi: JitVector, h: JitVector, cos_d: JitFloat) -> JitFloat:
        return self.density(h)


@dataclass(frozen=True)
class Visible:
    """Sampling of the normals that are visible from wi, on a surface of V-grooves.

    The facets of a groove have the normal h, drawn from the `distribution`, and its mirror image
    about the surface normal. One of them is chosen in proportion to its area as seen from wi. The
    `distribution` has to be unchanged by a half turn about the surface normal. The density is
    G1 (wi·h)⁺ D / cosθ_i [Heitz & d'Eon 2014], with the G1 of `v_groove`.
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


def _normal_from_slopes(vector: Any, x: JitFloat, y: JitFloat) -> JitVector:
    """Return the unit normal of a facet with the slopes `x` and `y`, of the type `vector`."""
    inverse = dr.rsqrt(1 + x * x + y * y)
    return vector(x * inverse, y * inverse, inverse)


def reflect_by_facets(slopes: TrowbridgeReitz, wi: JitVector, wo: JitVector) -> JitFloat:
    """Return D G₂ / (4 μ_i μ_o), the BRDF of facets that reflect all light."""
    return slopes.D(half_vector(wi, wo)) * slopes.G2(wi, wo) / (4 * wi.z * wo.z)
