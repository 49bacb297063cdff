"""glTF: the metallic-roughness material of glTF 2.0 with the extensions for plastics and coats.

    f = K (c ((1 - m) (1 - F) / π + m S (1 - s)) + S ((1 - m) F + m s)) + k F_c S_c
    S = D G₂ / (4 μ_i μ_o),   s = (1 - V·H)⁵,   F = w (F₀ + (1 - F₀) s),   F₀ = ((η - 1) / (η + 1))²
    K = √((1 - k F_i) (1 - k F_o))

c is the base colour, m the metalness, w the factor `specular` and η the index of refraction; V and
H are the direction of view and the half vector, μ_i and μ_o the cosines of both directions to the
normal. D is the Trowbridge-Reitz distribution with the width α = q² of the roughness q, and along
the tangent with α + (1 - α) A² of the anisotropy A; G₂ is Smith's height-correlated shadowing. The
term S_c of a coat has the width of its own roughness and no anisotropy. k is the coat's strength
and F_c its reflectance by Schlick, with F₀ = 0.04, of the half vector; F_i and F_o are those of
both directions.

With `highlights=coloured` the model has a coloured highlight in place of metalness and index:

    f = K (a (1 - w s) / π + b w S (1 - s) + w S s) + k F_c S_c

b is F₀ in each channel, `specularFactor` w and `specularColorFactor` b / F₀(η) in a file, a the
base colour times 1 - w b_max with the largest channel of b, and metalness 0. The file then has 1 -
w b_max - w (1 - b_max) s in place of (1 - w b_max) (1 - w s), 0.5 % of the value at most in fits to
neural reconstructions of three MERL materials. This form fits better, and metals, too: b may be 1.

[Khronos 2021], appendix B, and the extensions specular, ior, anisotropy and clearcoat. Parameters
have the names of the file, where `base_color` is called `baseColorFactor` and so on, and
`anisotropy` `anisotropyStrength`; a negative one stands for a rotation of 90°. The specification
leaves room: it prints separable shadowing, where three.js and Khronos' own viewer take this one. It
darkens the base below a coat by 1 - k F_v of the direction of view alone, which is not reciprocal.
K is the geometric mean of this factor for both directions: the same where they are equally steep,
and other by 1.14 times where one is at the normal and the other at 75°. White dielectrics reflect
up to 1.12 times the light that arrives (at 85°, η = 1.5). Sheen is left out. It suits metals,
plastics and clear coats on both.
"""

from functools import cached_property
from typing import Any

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitVector
from brdfkit.core.geometry.vectors import cos_theta_d
from brdfkit.model import Model, Parameter, anisotropy, option, shape, weight
from brdfkit.model.lobes import Cosine, HalfVector, Lobe, add_lobes
from brdfkit.model.microfacet import (
    TrowbridgeReitz,
    fifth_power,
    grazing_share,
    pass_layer,
    reflect_by_facets,
    reflectance_from_ior,
    schlick,
)

COAT_F0 = 0.04

# The ball in the picture on the model's page: lacquered copper
PICTURE = {
    "base_color": [0.95, 0.64, 0.54],
    "metallic": 1.0,
    "roughness": 0.5,
    "clearcoat": 1.0,
    "clearcoat_roughness": 0.12,
}


class GLTF(Model):
    highlights = option(
        "white",
        ("white", "coloured"),
        "those of plastics: white, or of a free colour, without metalness",
    )
    base_color = weight(0.5, "c: base colour", (0.0, 1.0))
    metallic = shape(0.0, (0.0, 1.0), "m: metalness")
    roughness = shape(0.5, (0.04, 1.0), "q: roughness, the root of the slopes' width", width=2)
    anisotropy = anisotropy((-1.0, 1.0), "A: anisotropy, above 0 for slopes that are wide along x")
    ior = shape(1.5, (1.0, 2.5), "η: index of refraction")
    specular = shape(1.0, (0.0, 1.0), "w: factor of the highlight of a plastic")
    clearcoat = shape(0.0, (0.0, 1.0), "k: strength of the coat")
    clearcoat_roughness = shape(0.3, (0.04, 1.0), "roughness of the coat")

    @classmethod
    def more_parameters(cls) -> dict[str, Parameter | None]:
        if cls.highlights == "white":
            return {}
        return {
            **dict.fromkeys(("base_color", "metallic", "ior")),
            "diffuse_color": weight(0.4, "a: base colour times 1 - max F₀", (0.0, 1.0)),
            "specular_color": weight(0.1, "F₀: colour of the highlight", (0.0, 1.0)),
        }

    def slopes(self) -> TrowbridgeReitz:
        """Return the distribution of the main highlight's normals."""
        alpha = dr.square(self.roughness)
        wide = alpha + (1 - alpha) * dr.square(self.anisotropy)
        along_x = self.anisotropy >= 0
        return TrowbridgeReitz(dr.select(along_x, wide, alpha), dr.select(along_x, alpha, wide))

    def fresnel(self, share: JitFloat) -> JitFloat:
        """Return the reflectance of a plastic's facets, given the `share` of grazing incidence."""
        f0 = reflectance_from_ior(self.ior)
        return self.specular * (f0 + (1 - f0) * share)

    def below_coat(self, wi: JitVector, wo: JitVector) -> JitFloat:
        """Return the share K of the base's light that the coat lets pass."""
        return pass_layer(*(self.clearcoat * schlick(COAT_F0, w.z) for w in (wi, wo)))

    def diffuse_brdf(self, wi: JitVector, wo: JitVector) -> JitFloat:
        if self.highlights == "coloured":
            passing = 1 - self.specular * grazing_share(wi, wo)
            return passing / dr.pi * self.below_coat(wi, wo)
        passing = 1 - self.fresnel(grazing_share(wi, wo))
        return (1 - self.metallic) / dr.pi * passing * self.below_coat(wi, wo)

    def facets(self, wi: JitVector, wo: JitVector) -> JitFloat:
        return reflect_by_facets(self.slopes(), wi, wo) * self.below_coat(wi, wo)

    def metal_brdf(self, wi: JitVector, wo: JitVector) -> JitFloat:
        metal = self.metallic if self.highlights == "white" else self.specular
        return metal * self.facets(wi, wo) * (1 - grazing_share(wi, wo))

    def dielectric_brdf(self, wi: JitVector, wo: JitVector) -> JitFloat:
        share = grazing_share(wi, wo)
        if self.highlights == "coloured":
            return self.specular * share * self.facets(wi, wo)
        F = (1 - self.metallic) * self.fresnel(share) + self.metallic * share
        return F * self.facets(wi, wo)

    def coat_brdf(self, wi: JitVector, wo: JitVector) -> JitFloat:
        F = schlick(COAT_F0, cos_theta_d(wi, wo))
        return self.clearcoat * F * reflect_by_facets(self.coat_slopes(), wi, wo)

    def coat_slopes(self) -> TrowbridgeReitz:
        """Return the distribution of the coat's normals."""
        alpha = dr.square(self.clearcoat_roughness)
        return TrowbridgeReitz(alpha, alpha)

    @cached_property
    def samplings(self) -> tuple[Any, ...]:
        """The samplings of the diffuse term, of the main highlight and of the coat."""
        return Cosine(), HalfVector(self.slopes()), HalfVector(self.coat_slopes())

    def lobes(self) -> tuple[Lobe, ...]:
        cosine, facets, _ = self.samplings
        if self.highlights == "coloured":
            highlight = Lobe(self.metal_brdf, facets, lambda wi: self.specular)
            return Lobe(self.diffuse_brdf, cosine, diffuse=True), highlight
        m = self.metallic
        diffuse = Lobe(self.diffuse_brdf, cosine, lambda wi: 1 - m, diffuse=True)
        metal = Lobe(self.metal_brdf, facets, lambda wi: m * (1 - fifth_power(1 - wi.z)))
        return (add_lobes(diffuse, metal),)

    def fixed_lobes(self) -> tuple[Lobe, ...]:
        _, facets, coat = self.samplings

        def dielectric_energy(wi: JitVector) -> JitFloat:
            share = fifth_power(1 - wi.z)
            if self.highlights == "coloured":
                return self.specular * share
            return (1 - self.metallic) * self.fresnel(share) + self.metallic * share

        return (
            Lobe(self.dielectric_brdf, facets, dielectric_energy),
            Lobe(self.coat_brdf, coat, lambda wi: self.clearcoat * schlick(COAT_F0, wi.z)),
        )
