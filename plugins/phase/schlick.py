"""Schlick: a phase function close to Henyey-Greenstein's, without a power.

    p(μ) = (1 - k²) / (4π (1 - kμ)²),   μ = cosine of the angle by which light is deflected

μ = 1 is straight on: light goes forward for k > 0, back for k < 0, and evenly for k = 0. Its mean
cosine is 1/k - (1 - k²)/(2k²) ln((1 + k)/(1 - k)), about 2k/3 for small k; the usual
k = 1.55 g - 0.55 g³ makes it resemble Henyey-Greenstein's of the mean cosine g, although its own
mean cosine differs.

[Blasi et al. 1993]; its inverse distribution function is exact.
"""

import drjit as dr

from brdfkit.host.declared import declared, number

PARAMETERS = {
    "k": number(0.5, (-0.999, 0.999), "asymmetry: above 0 forward, below 0 back"),
}


def density(k, mu):
    """p(μ) [sr⁻¹]."""
    return (1 - k * k) / (4 * dr.pi * dr.square(1 - k * mu))


def cosine(k, u):
    """The μ below which the share `u` of the scattered light lies."""
    return (2 * u + k - 1) / (2 * k * u - k + 1)


def define(mi):
    """The class of `mi.PhaseFunction` for the current variant."""

    class Schlick(declared(mi.PhaseFunction, PARAMETERS)):
        def __init__(self, props):
            super().__init__(props)
            self.m_flags = mi.PhaseFunctionFlags.Anisotropic

        def sample(self, ctx, interaction, sample1, sample2, active=True):
            mu = cosine(self.k, sample2.x)
            radius = dr.safe_sqrt(1 - mu * mu)
            sin_phi, cos_phi = dr.sincos(2 * dr.pi * sample2.y)
            local = mi.Vector3f(radius * cos_phi, radius * sin_phi, mu)
            # Neither the direction nor its density in the weight has derivatives
            wo = dr.detach(mi.Frame3f(-interaction.wi).to_world(local))
            value, pdf = self.eval_pdf(ctx, interaction, wo, active)
            return wo, value / dr.detach(pdf), pdf

        def eval_pdf(self, ctx, interaction, wo, active=True):
            pdf = density(self.k, -dr.dot(interaction.wi, wo))  # wi points back
            return mi.Spectrum(pdf), pdf

    return Schlick
