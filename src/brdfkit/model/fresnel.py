"""The base class of microfacet models with Schlick's Fresnel reflectance, grey or coloured.

A facet has the reflectance F = F₀ + (F₉₀ - F₀) (1 - V·H)⁵ [Schlick 1994], where V·H is the cosine
of the angle of incidence, and F₀ and F₉₀ are the values at normal and at grazing incidence. The
microfacet term is F times the strength k_s. By default k_s is a weight, F₀ a shape parameter, and
F₉₀ is 1. With the option `fresnel=coloured`, k_s F₀ and k_s F₉₀ are weights, with one number for
each colour channel, because F is linear in F₀ and F₉₀.
"""

from collections.abc import Callable
from typing import Any

from brdfkit.core.array_types import JitFloat, JitVector
from brdfkit.model.lobes import Lobe, Sampling, make_factored_lobe
from brdfkit.model.microfacet import fifth_power, schlick
from brdfkit.model.model import Model
from brdfkit.model.parameters import Parameter, option, weight


class FresnelModel(Model):
    """A microfacet model with the parameters `specular_reflectance` (k_s) and `f0` (F₀).

    With the option `fresnel=coloured`, the strengths at normal and at grazing incidence are weights
    in place of these two.
    """

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
        """Return the lobes of the microfacet term k_s F · `D(h)` · `geometry(wi, wo)` [sr⁻¹].

        F is Schlick's reflectance. There is one lobe by default, and there are two with
        `fresnel=coloured`. `sampling` draws their directions; `albedo` is the approximate albedo of
        `D(h)` · `geometry(wi, wo)`.
        """

        def make_lobe(F: Callable[[JitFloat], JitFloat]) -> Lobe:
            def facet_factor(h: JitVector, cos_d: JitFloat) -> JitFloat:
                return D(h) * F(cos_d)

            return make_factored_lobe(facet_factor, geometry, sampling, lambda wi: albedo * F(wi.z))

        if self.fresnel == "schlick":
            return (make_lobe(lambda cosine: schlick(self.f0, cosine)),)
        return make_lobe(lambda c: 1 - fifth_power(1 - c)), make_lobe(lambda c: fifth_power(1 - c))
