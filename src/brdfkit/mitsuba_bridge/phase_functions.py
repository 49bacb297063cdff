"""The base of phase functions that depend on the angle alone by which they deflect light."""

import drjit as dr

from brdfkit.mitsuba_bridge.properties.declarations import derive_plugin


def derive_phase_function(mi, parameters):
    """A class derived from `mi.PhaseFunction`, with the `parameters` of `derive_plugin`.

    A class derived from it adds `density(mu)`, p(μ) [sr⁻¹] at the cosine μ of the angle, 1 for
    straight on, and `cosine(lobe, u)`, a random μ for two numbers of 0 to 1.
    """

    class Deflection(derive_plugin(mi.PhaseFunction, parameters)):
        def __init__(self, props):
            super().__init__(props)
            self.m_flags = mi.PhaseFunctionFlags.Anisotropic

        def sample(self, ctx, interaction, sample1, sample2, active=True):
            mu = self.cosine(sample1, sample2.x)
            radius = dr.safe_sqrt(1 - mu * mu)
            sin_phi, cos_phi = dr.sincos(2 * dr.pi * sample2.y)
            local = mi.Vector3f(radius * cos_phi, radius * sin_phi, mu)
            # Neither the direction nor its density in the weight has derivatives
            wo = dr.detach(mi.Frame3f(-interaction.wi).to_world(local))
            value, pdf = self.eval_pdf(ctx, interaction, wo, active)
            return wo, value / dr.detach(pdf), pdf

        def eval_pdf(self, ctx, interaction, wo, active=True):
            pdf = self.density(-dr.dot(interaction.wi, wo))  # wi points back
            return mi.Spectrum(pdf), pdf

    return Deflection


def density(n, mu):
    """p(μ) = (1 + (n + 1) ((1 + μ) / 2)ⁿ) / 8π [sr⁻¹]."""
    return (1 + (n + 1) * (0.5 + 0.5 * mu) ** n) / (8 * dr.pi)


def cosine(n, lobe, u):
    """A μ of one of the halves, which `lobe` chooses: the one below which its share `u` lies."""
    return 2 * dr.select(lobe < 0.5, u, u ** (1 / (n + 1))) - 1


def define_even_and_forward(mi, n):
    """The class of `mi.PhaseFunction` with the power `n`."""

    class EvenAndForward(derive_phase_function(mi, {})):
        def density(self, mu):
            return density(n, mu)

        def cosine(self, lobe, u):
            return cosine(n, lobe, u)

    return EvenAndForward
