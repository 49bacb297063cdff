"""Models of facets with Schlick's Fresnel reflectance, grey or coloured at both ends.

F = F₀ + (F₉₀ - F₀) (1 - V·H)⁵ [Schlick 1994] is linear in the reflectances F₀ at normal and F₉₀ at
grazing incidence. So both can be weights, one for each channel, in place of the strength k_s and of
F₀. Otherwise F₀ is a shape parameter and F₉₀ is 1.
"""

from collections.abc import Callable
from typing import Any

from brdfkit.core.array_types import JitFloat, JitVector
from brdfkit.model.lobes import Lobe, Sampling, make_factored_lobe
from brdfkit.model.microfacet import fifth_power, schlick
from brdfkit.model.model import Model
from brdfkit.model.parameters import Parameter, option, weight


class FresnelModel(Model):
    """A model with the parameters `specular_reflectance` and `f0`, and an option for its F."""

    fresnel = option(
        "schlick",
        ("schlick", "coloured"),
        "the factor of the facets: k_s (F₀ + (1 - F₀) (1 - V·H)⁵), or k₀ + (k₉₀ - k₀) (1 - V·H)⁵ "
        "with two colours",
    )

    @classmethod
    def more_parameters(cls) -> dict[str, Parameter | None]:
        if cls.fresnel == "schlick":
            return {}
        k_s, f0 = (cls._declared[name].default or 0 for name in ("specular_reflectance", "f0"))
        return {
            "specular_reflectance": None,
            "f0": None,
            "f0_reflectance": weight(k_s * f0, "k₀ = k_s F₀: strength at normal incidence"),
            "f90_reflectance": weight(k_s, "k₉₀ = k_s F₉₀: strength at grazing incidence"),
        }

    def make_fresnel_lobes(
        self,
        D: Callable[[Any], Any],
        geometry: Callable[[Any, Any], Any],
        sampling: Sampling,
        albedo: float = 1.0,
    ) -> tuple[Lobe, ...]:
        """Return the lobe or the two lobes of k_s F `D(h)` `geometry(wi, wo)` [sr⁻¹].

        `albedo` is the approximate albedo of the term without k_s F.
        """

        def lobe(F: Callable[[JitFloat], JitFloat]) -> Lobe:
            def facets(h: JitVector, cos_d: JitFloat) -> JitFloat:
                return D(h) * F(cos_d)

            return make_factored_lobe(facets, geometry, sampling, lambda wi: albedo * F(wi.z))

        if self.fresnel == "schlick":
            return (lobe(lambda cosine: schlick(self.f0, cosine)),)
        return lobe(lambda c: 1 - fifth_power(1 - c)), lobe(lambda c: fifth_power(1 - c))
