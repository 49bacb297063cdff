"""OpenPBR: the surface of OpenPBR and MaterialX, opaque, with a rough base, a coat and fuzz.

    f = K_f (K_c (c ((1 - m) K_s R / π + m S (1 - s)) + S ((1 - m) F + m s)) + k_c F_c S_c)
        + c_f k_f (Z(L, V) + Z(V, L)) / 2
    S = D G₂ / (4 μ_i μ_o),   s = (1 - V·H)⁵
    K = √((1 - k E(μ_i)) (1 - k E(μ_o)))

c is the base colour, m the metalness; L, V and H are the directions of light and view and the half
vector, μ_i and μ_o the cosines of both directions to the normal. R is 1, or the rough diffuse
surface of `eon` with terms of c and c². D is the Trowbridge-Reitz distribution of the widths q² √(2
/ (1 + b²)) and b times that, with b = 1 - |A|, the roughness q and the anisotropy A; G₂ is Smith's
height-correlated shadowing. F and F_c are Fresnel's reflectances of the base and of the coat, of
the index 1.6. The coat, of the strength k_c, makes the base rougher, q⁴ + 2 q_c⁴ in place of q⁴ up
to 1, and its index relative to the coat's smaller. Z is the fuzz of the strength k_f and the colour
c_f, MaterialX's linearly transformed cosine. The form `full` has the rough base and the fuzz.

Each layer darkens those below by its albedo E: K_s, K_c and K_f with k = 1, k_c and k_f. Renderers
take 1 - k E(μ) of the direction of view alone, which is not reciprocal. K is the geometric mean of
this factor for both directions: the same where they are equally steep, and other by 1.14 times for
a coat where one is at the normal and the other at 75°. The mean of both Z stands for Z(V, L). White
surfaces reflect up to 1.11 times the light that arrives at 85°, with fuzz up to 1.23 times. Two
kinks are rounded for the sake of fits: q⁴ + 2 q_c⁴ where it reaches 1, by 2 % of the roughness, and
the index where it is the coat's.

Parameters have the names of OpenPBR; `base_color` includes `base_weight`, and a negative anisotropy
stands for a rotation of 90°. Highlights and coat are white, `coat_darkening` is 0. There is no
transmission, subsurface scattering or thin film, and no light that facets reflect twice.

[Andersson et al. 2024]; [Portsmouth et al. 2025]; [Zeltner et al. 2022]. It suits metals, plastics,
coated paints and cloth.
"""

from functools import cached_property
from typing import Any

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitVector
from brdfkit.core.geometry.vectors import cos_theta_d
from brdfkit.model import Model, Parameter, anisotropy, option, shape, weight
from brdfkit.model.ggx_albedo import schlick_albedo
from brdfkit.model.lobes import Cosine, HalfVector, Lobe, add_lobes
from brdfkit.model.microfacet import (
    TrowbridgeReitz,
    dielectric_reflectance,
    fifth_power,
    grazing_share,
    pass_layer,
    reflect_by_facets,
    reflectance_from_ior,
    schlick,
)
from brdfkit.model.rough_diffuse import scatter_often, scatter_once

COAT_IOR = 1.6
COAT_F0 = reflectance_from_ior(COAT_IOR)

# The ball in the picture on the model's page: aubergine lacquer on a satin ground
PICTURE = {
    "base_color": [0.12, 0.02, 0.06],
    "specular_roughness": 0.4,
    "coat_weight": 1.0,
    "coat_roughness": 0.1,
}


class OpenPBR(Model):
    form = option("short", ("short", "full"), "without or with a rough diffuse base, and fuzz")
    base_color = weight(0.5, "c: base colour", (0.0, 1.0))
    base_metalness = shape(0.0, (0.0, 1.0), "m: metalness")
    specular_roughness = shape(0.3, (0.04, 1.0), "q: roughness of the highlight", width=2)
    specular_roughness_anisotropy = anisotropy(
        (-0.95, 0.95), "A: anisotropy, above 0 for slopes that are wide along x"
    )
    specular_ior = shape(1.5, (1.0, 2.5), "η: index of refraction")
    coat_weight = shape(0.0, (0.0, 1.0), "k_c: strength of the coat")
    coat_roughness = shape(0.3, (0.04, 1.0), "q_c: roughness of the coat")

    @classmethod
    def more_parameters(cls) -> dict[str, Parameter | None]:
        if cls.form == "short":
            return {}
        return {
            "fuzz_color": weight(1.0, "c_f: colour of the fuzz", (0.0, 1.0)),
            "base_diffuse_roughness": shape(0.0, (0.0, 1.0), "roughness of the diffuse base"),
            "fuzz_weight": shape(0.0, (0.0, 1.0), "k_f: strength of the fuzz"),
            "fuzz_roughness": shape(0.5, (0.1, 1.0), "roughness of the fuzz"),
        }

    @cached_property
    def alpha(self) -> JitFloat:
        """The mean width of the slopes of the highlight, which a coat makes rougher."""
        own = dr.square(dr.square(self.specular_roughness))
        coated = limit_to_one(own + 2 * dr.square(dr.square(self.coat_roughness)))
        roughness = dr.sqrt(dr.sqrt(coated))
        return dr.square(
            self.specular_roughness + self.coat_weight * (roughness - self.specular_roughness)
        )

    def slopes(self) -> TrowbridgeReitz:
        """Return the distribution of the main highlight's normals."""
        along_x = self.specular_roughness_anisotropy >= 0
        b = 1 - dr.select(along_x, 1, -1) * self.specular_roughness_anisotropy
        wide = self.alpha * dr.sqrt(2 / (1 + b * b))
        return TrowbridgeReitz(
            dr.select(along_x, wide, b * wide), dr.select(along_x, b * wide, wide)
        )

    def coat_slopes(self) -> TrowbridgeReitz:
        """Return the distribution of the coat's normals."""
        alpha = dr.square(self.coat_roughness)
        return TrowbridgeReitz(alpha, alpha)

    @cached_property
    def ior(self) -> JitFloat:
        """The index of refraction of the base relative to what lies above it."""
        # The larger one of both ratios, rounded where they are equal, so that it has derivatives
        ratio = dr.log(self.specular_ior / COAT_IOR)
        below_coat = dr.exp(dr.sqrt(ratio * ratio + 1e-4))
        return self.specular_ior + self.coat_weight * (below_coat - self.specular_ior)

    def below_fuzz(self, wi: JitVector, wo: JitVector) -> JitFloat:
        if self.form == "short":
            return 1.0
        return pass_layer(
            *(self.fuzz_weight * fuzz_albedo(w.z, self.fuzz_roughness) for w in (wi, wo))
        )

    def below_coat(self, wi: JitVector, wo: JitVector) -> JitFloat:
        alpha = dr.square(self.coat_roughness)
        coat = (self.coat_weight * schlick_albedo(w.z, alpha, COAT_F0) for w in (wi, wo))
        return pass_layer(*coat) * self.below_fuzz(wi, wo)

    def below_highlight(self, wi: JitVector, wo: JitVector) -> JitFloat:
        f0 = reflectance_from_ior(self.ior)
        highlight = (schlick_albedo(w.z, self.alpha, f0) for w in (wi, wo))
        return (1 - self.base_metalness) * pass_layer(*highlight) * self.below_coat(wi, wo)

    def diffuse_brdf(self, wi: JitVector, wo: JitVector) -> JitFloat:
        rough = self.form == "full"
        once = scatter_once(wi, wo, self.base_diffuse_roughness) if rough else 1 / dr.pi
        return once * self.below_highlight(wi, wo)

    def diffuse_brdf_by_square(self, wi: JitVector, wo: JitVector) -> JitFloat:
        often = scatter_often(wi, wo, self.base_diffuse_roughness)
        return often * self.below_highlight(wi, wo)

    def facets(self, wi: JitVector, wo: JitVector) -> JitFloat:
        return reflect_by_facets(self.slopes(), wi, wo) * self.below_coat(wi, wo)

    def metal_brdf(self, wi: JitVector, wo: JitVector) -> JitFloat:
        return self.base_metalness * self.facets(wi, wo) * (1 - grazing_share(wi, wo))

    def dielectric_brdf(self, wi: JitVector, wo: JitVector) -> JitFloat:
        m, F = self.base_metalness, dielectric_reflectance(cos_theta_d(wi, wo), self.ior)
        return ((1 - m) * F + m * grazing_share(wi, wo)) * self.facets(wi, wo)

    def coat_brdf(self, wi: JitVector, wo: JitVector) -> JitFloat:
        F = dielectric_reflectance(cos_theta_d(wi, wo), COAT_IOR)
        facets = reflect_by_facets(self.coat_slopes(), wi, wo)
        return self.coat_weight * F * facets * self.below_fuzz(wi, wo)

    def fuzz_brdf(self, wi: JitVector, wo: JitVector) -> JitFloat:
        r = self.fuzz_roughness
        return 0.5 * self.fuzz_weight * (scatter_by_fuzz(wi, wo, r) + scatter_by_fuzz(wo, wi, r))

    @cached_property
    def samplings(self) -> tuple[Any, ...]:
        """The samplings of diffuse terms, of the main highlight and of the coat."""
        return Cosine(), HalfVector(self.slopes()), HalfVector(self.coat_slopes())

    def lobes(self) -> tuple[Lobe, ...]:
        m, (cosine, facets, _) = self.base_metalness, self.samplings
        square = self.diffuse_brdf_by_square if self.form == "full" else None
        diffuse = Lobe(self.diffuse_brdf, cosine, lambda wi: 1 - m, square, diffuse=True)
        metal = Lobe(self.metal_brdf, facets, lambda wi: m * (1 - fifth_power(1 - wi.z)))
        base = add_lobes(diffuse, metal)
        if self.form == "short":
            return (base,)

        def fuzz_energy(wi: JitVector) -> JitFloat:
            return self.fuzz_weight * fuzz_albedo(wi.z, self.fuzz_roughness)

        fuzz = Lobe(self.fuzz_brdf, cosine, fuzz_energy, diffuse=True)
        return base, fuzz

    def fixed_lobes(self) -> tuple[Lobe, ...]:
        m, (_, facets, coat) = self.base_metalness, self.samplings

        def dielectric_energy(wi: JitVector) -> JitFloat:
            return (1 - m) * dielectric_reflectance(wi.z, self.ior) + m * fifth_power(1 - wi.z)

        return (
            Lobe(self.dielectric_brdf, facets, dielectric_energy),
            Lobe(self.coat_brdf, coat, lambda wi: self.coat_weight * schlick(COAT_F0, wi.z)),
        )


def limit_to_one(x: JitFloat) -> JitFloat:
    """Return the smaller one of x and 1, rounded where they are equal, for the sake of fits."""
    eighth = dr.square(dr.square(dr.square(x)))
    return x * dr.rsqrt(dr.sqrt(dr.sqrt(1 + eighth)))


def fuzz_albedo(cosine: JitFloat, roughness: JitFloat) -> JitFloat:
    """Return the directional albedo of the fuzz, by MaterialX's Gaussian fit."""
    r = roughness
    width = r * (0.0206607 + 1.58491 * r) / (0.0379424 + r * (1.32227 + r))
    fall = r * (-1.14885 + r * (1.7932 - 0.95943 * r * r))
    middle = r * (-0.193854 + fall) / (0.046391 + r)
    offset = r * (0.000654023 + (-0.0207818 + 0.119681 * r) * r) / (1.26264 + r * (r - 1.92021))
    z = (cosine - middle) / width
    return dr.minimum(dr.exp(-0.5 * z * z) / (width * dr.sqrt(2 * dr.pi)) + offset, 1)


def scatter_by_fuzz(v: JitVector, w: JitVector, roughness: JitFloat) -> JitFloat:
    """Return the BRDF of white fuzz for light from `w`, seen from `v`, which is not reciprocal.

    The lobe is a cosine, transformed by a matrix with the diagonal a, a, 1 and the shear b. The
    numbers a and b are MaterialX's fits.
    """
    x, r = v.z, roughness
    a = (2.58126 * x + 0.813703 * r) * r / (1 + 0.310327 * x * x + 2.60994 * x * r)
    # The shear without its factor √(1 - x), which cancels the sine that the tangent divides by
    b = (r - 1) * r * r * r / (0.0000254053 + 1.71228 * x - 1.71506 * x * r + 1.34174 * r * r)
    along = (v.x * w.x + v.y * w.y) * dr.rsqrt(1 + x)
    z = w.z
    length = a * a * (1 - z * z) + 2 * a * b * along * z + (b * b * (1 - x) + 1) * z * z
    return fuzz_albedo(x, r) * dr.square(a / length) / dr.pi
