"""Disney: the principled model of animated films, by the formulas of Mitsuba's `principled`.

    f = c ((1 - m) R / π + m D G (1 - s) / (4 μ_i μ_o)) + D G ((1 - m) F + m s) / (4 μ_i μ_o)
        + k_c/4 F_c D_c G_c + k_s (1 - m) s
    R = (1 - F_i/2) (1 - F_o/2) + r (F_i + F_o + F_i F_o (r - 1)),   r = 2 q (V·H)²
    s = (1 - V·H)⁵,   F_i = (1 - μ_i)⁵,   F_o = (1 - μ_o)⁵,   F_c = 0.04 + 0.96 s

c is the base colour, m the metalness and q the roughness; V and H are the direction of view and the
half vector, μ_i and μ_o the cosines of both directions to the normal. D is the Trowbridge-Reitz
distribution of the widths q² / a and q² a, with a = √(1 - 0.9 |A|) and the anisotropy A, and G the
product of Smith's shadowing of both directions. F is Fresnel's reflectance of a dielectric. A coat
of the strength k_c has the distribution D_c of the width 0.1 - 0.099 g with the gloss g; its
shadowing G_c is always that of the width 0.25. k_s is the strength of a sheen at the rim.

[Burley 2012]; [Burley 2015]. The formulas are those of Mitsuba 3, without transmission, flatness
and tints; with A ≥ 0, `principled` draws the same image: values differ by 0.06 % at most, and for
coats of g above 0.9 by up to 1.4 %, which single precision rounds in Mitsuba. There `base_color`,
`metallic`, `roughness`, `sheen`, `clearcoat` and `clearcoat_gloss` have these names, `anisotropy`
is called `anisotropic` and `ior` is `eta`. A negative anisotropy widens the highlight along y;
Mitsuba has none, and needs the surface turned by 90° instead. Blender's Principled differs: it has
the shadowing of both directions together, a diffuse term of c/π times what the highlight leaves
over in the direction of view, without retro-reflection, and by default the light that facets
scatter several times, which is 1 to 15 % of a metal's at q = 0.5. White dielectrics reflect more
light than arrives: 1.04 times as much at normal incidence, and 1.44 times at 85° for q = 1. It
suits metals, plastics, and coated or cloth-like surfaces of one base colour.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitVector
from brdfkit.core.geometry.vectors import cos_theta_d, half_vector
from brdfkit.model import Model, anisotropy, shape, weight
from brdfkit.model.lobes import Cosine, HalfVector, Lobe, add_lobes
from brdfkit.model.microfacet import (
    TrowbridgeReitz,
    dielectric_reflectance,
    fifth_power,
    grazing_share,
    schlick,
)

SMALLEST_WIDTH = 0.001  # of the slopes, as in Mitsuba


@dataclass(frozen=True)
class Berry:
    """The distribution of the coat's normals h, D in proportion to 1 / (1 - (1 - α²) cos²θ_h).

    Its tails are longer than those of Trowbridge & Reitz. `alpha` is below 1.
    [Burley 2012, appendix B.2]
    """

    alpha: Any

    def D(self, h: JitVector) -> JitFloat:
        squared = dr.square(self.alpha)
        s = h.x * h.x + h.y * h.y + squared * h.z * h.z
        return (squared - 1) / (dr.pi * dr.log(squared) * s)

    def sample(self, wi: JitVector, u: JitVector) -> JitVector:
        sin_phi, cos_phi = dr.sincos(2 * dr.pi * u.y)
        squared = dr.square(self.alpha)
        # sin²θ_h is the small difference of two small numbers where the coat is glossy
        sine_squared = (dr.exp(dr.log(squared) * u.x) - squared) / (1 - squared)
        sine = dr.sqrt(dr.clip(sine_squared, 0, 1 - 1e-6))
        return type(wi)(sine * cos_phi, sine * sin_phi, dr.sqrt(1 - sine * sine))

    def pdf(self, wi: JitVector, h: JitVector, cos_d: JitFloat) -> JitFloat:
        return self.D(h) * h.z


# The ball in the picture on the model's page: metallic paint under a clear coat
PICTURE = {
    "base_color": [0.5, 0.05, 0.08],
    "metallic": 0.6,
    "roughness": 0.45,
    "clearcoat": 1.0,
    "clearcoat_gloss": 0.9,
}


class Disney(Model):
    base_color = weight(0.5, "c: base colour", (0.0, 1.0))
    metallic = shape(0.0, (0.0, 1.0), "m: metalness")
    roughness = shape(0.5, (0.04, 1.0), "q: roughness, the root of the slopes' width", width=2)
    anisotropy = anisotropy((-1.0, 1.0), "A: anisotropy, above 0 for slopes that are wide along x")
    ior = shape(1.5, (1.0, 2.5), "η: index of refraction")
    clearcoat = shape(0.0, (0.0, 1.0), "k_c: strength of the coat")
    clearcoat_gloss = shape(0.9, (0.0, 1.0), "g: gloss of the coat")
    sheen = shape(0.0, (0.0, 1.0), "k_s: strength of the sheen")

    def diffuse_brdf(self, wi: JitVector, wo: JitVector) -> JitFloat:
        Fi, Fo = fifth_power(1 - wi.z), fifth_power(1 - wo.z)
        r = 2 * self.roughness * dr.square(cos_theta_d(wi, wo))
        entering_and_leaving = (1 - 0.5 * Fi) * (1 - 0.5 * Fo)
        retro_reflection = r * (Fi + Fo + Fi * Fo * (r - 1))
        return (1 - self.metallic) / dr.pi * (entering_and_leaving + retro_reflection)

    def slopes(self) -> TrowbridgeReitz:
        """Return the distribution of the main highlight's normals."""
        wide = self.anisotropy >= 0
        ratio = 1 - dr.select(wide, 0.9, -0.9) * self.anisotropy
        alpha, aspect = dr.square(self.roughness), dr.sqrt(ratio)
        along, across = alpha / aspect, alpha * aspect
        return TrowbridgeReitz(
            dr.maximum(dr.select(wide, along, across), SMALLEST_WIDTH),
            dr.maximum(dr.select(wide, across, along), SMALLEST_WIDTH),
        )

    def metal_brdf(self, wi: JitVector, wo: JitVector) -> JitFloat:
        return self.metallic * self.facets(wi, wo) * (1 - grazing_share(wi, wo))

    def dielectric_brdf(self, wi: JitVector, wo: JitVector) -> JitFloat:
        F = dielectric_reflectance(cos_theta_d(wi, wo), self.ior)
        F = (1 - self.metallic) * F + self.metallic * grazing_share(wi, wo)
        return self.facets(wi, wo) * F

    def facets(self, wi: JitVector, wo: JitVector) -> JitFloat:
        slopes = self.slopes()
        G = slopes.G1(wi) * slopes.G1(wo)
        return slopes.D(half_vector(wi, wo)) * G / (4 * wi.z * wo.z)

    def coat_brdf(self, wi: JitVector, wo: JitVector) -> JitFloat:
        h, shadowing = half_vector(wi, wo), TrowbridgeReitz(0.25, 0.25)
        F = schlick(0.04, cos_theta_d(wi, wo))
        D = Berry(0.1 - 0.099 * self.clearcoat_gloss).D(h)
        return 0.25 * self.clearcoat * F * D * shadowing.G1(wi) * shadowing.G1(wo)

    def sheen_brdf(self, wi: JitVector, wo: JitVector) -> JitFloat:
        return self.sheen * (1 - self.metallic) * grazing_share(wi, wo)

    @cached_property
    def samplings(self) -> tuple[Any, ...]:
        """The samplings of diffuse terms, of the main highlight and of the coat."""
        coat = Berry(0.1 - 0.099 * self.clearcoat_gloss)
        return Cosine(), HalfVector(self.slopes()), HalfVector(coat)

    def lobes(self) -> tuple[Lobe, ...]:
        m, (cosine, facets, _) = self.metallic, self.samplings
        diffuse = Lobe(self.diffuse_brdf, cosine, lambda wi: 1 - m, diffuse=True)
        metal = Lobe(self.metal_brdf, facets, lambda wi: m * (1 - fifth_power(1 - wi.z)))
        return (add_lobes(diffuse, metal),)

    def fixed_lobes(self) -> tuple[Lobe, ...]:
        m, (cosine, facets, coat) = self.metallic, self.samplings

        def dielectric_energy(wi: JitVector) -> JitFloat:
            return (1 - m) * dielectric_reflectance(wi.z, self.ior) + m * fifth_power(1 - wi.z)

        return (
            Lobe(self.dielectric_brdf, facets, dielectric_energy),
            Lobe(self.coat_brdf, coat, lambda wi: 0.25 * self.clearcoat * schlick(0.04, wi.z)),
            Lobe(self.sheen_brdf, cosine, lambda wi: self.sheen * (1 - m) * 0.1, diffuse=True),
        )
