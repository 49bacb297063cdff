"""Models of facets with Schlick's Fresnel reflectance, grey or coloured at both ends.

F = F₀ + (F₉₀ - F₀) (1 - V·H)⁵ [Schlick 1994] is linear in the reflectances F₀ at normal and F₉₀ at
grazing incidence. So both can be weights, per channel, and take the place of k_s and of F₀, which
otherwise is a shape parameter, beside F₉₀ = 1.
"""

from brdfkit.model.lobes import make_factored_lobe
from brdfkit.model.microfacet import fifth_power, schlick
from brdfkit.model.model import Model
from brdfkit.model.parameters import option, weight


class FresnelModel(Model):
    """A model with the parameters `specular_reflectance` and `f0`, and an option for its F."""

    fresnel = option(
        "schlick",
        ("schlick", "coloured"),
        "the factor of the facets: k_s (F₀ + (1 - F₀) (1 - V·H)⁵), or k₀ + (k₉₀ - k₀) (1 - V·H)⁵ "
        "with two colours",
    )

    @classmethod
    def more_parameters(cls):
        if cls.fresnel == "schlick":
            return {}
        k_s, f0 = (cls._declared[name].default for name in ("specular_reflectance", "f0"))
        return {
            "specular_reflectance": None,
            "f0": None,
            "f0_reflectance": weight(k_s * f0, "k₀ = k_s F₀: strength at normal incidence"),
            "f90_reflectance": weight(k_s, "k₉₀ = k_s F₉₀: strength at grazing incidence"),
        }

    def make_fresnel_lobes(self, D, geometry, sampling, albedo=1.0):
        """The lobe, or the two, of the term `D(h)` `geometry(wi, wo)` [sr⁻¹], which lacks k_s F.

        `albedo`: about that of the term.
        """

        def lobe(F):
            def facets(h, cos_d):
                return D(h) * F(cos_d)

            return make_factored_lobe(facets, geometry, sampling, lambda wi: albedo * F(wi.z))

        if self.fresnel == "schlick":
            return (lobe(lambda cosine: schlick(self.f0, cosine)),)
        return lobe(lambda c: 1 - fifth_power(1 - c)), lobe(lambda c: fifth_power(1 - c))
