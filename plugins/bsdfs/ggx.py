"""GGX: the microfacet model in common use, with the Trowbridge-Reitz distribution.

    f = k_d / π + k_s D G₂ F / (4 (N·L)(N·V))

N, L and V are the normal and the directions of light and view. The distribution of normals D is
given by [Walter et al. 2007], Smith's height-correlated shadowing G₂ by [Heitz 2014], the Fresnel
reflectance F by Schlick. It suits most metals, paints and plastics, because its tails are long. It
has no retro-reflection and no scattering between facets.
"""

from brdfkit.core.array_types import JitFloat, JitVector
from brdfkit.model import follows, shape, weight
from brdfkit.model.fresnel import FresnelModel
from brdfkit.model.lobes import HalfVector, Lobe, lambertian
from brdfkit.model.microfacet import TrowbridgeReitz

# The ball in the picture on the model's page: polished gold, with a haze about its highlights
PICTURE = {
    "diffuse_reflectance": 0.0,
    "specular_reflectance": [1.0, 0.77, 0.34],
    "alpha_u": 0.12,
    "f0": 0.9,
}


class GGX(FresnelModel):
    diffuse_reflectance = weight(0.4, "k_d: albedo of the diffuse term")
    specular_reflectance = weight(0.5, "k_s: strength of the highlight")
    alpha_u = shape(0.2, (0.001, 1.0), "α_u: width of the slopes along x", log=True, width=1)
    alpha_v = follows("alpha_u", alpha_u, "α_v: width of the slopes along y")
    f0 = shape(0.5, (0.0, 1.0), "F₀: Fresnel reflectance at normal incidence")

    def lobes(self) -> tuple[Lobe, ...]:
        slopes = TrowbridgeReitz(self.alpha_u, self.alpha_v)

        def geometry_factor(wi: JitVector, wo: JitVector) -> JitFloat:
            return slopes.G2(wi, wo) / (4 * wi.z * wo.z)

        return lambertian(), *self.make_fresnel_lobes(slopes.D, geometry_factor, HalfVector(slopes))
