"""Schlick: a phase function close to Henyey-Greenstein's, without a power.

    p(μ) = (1 - k²) / (4π (1 - kμ)²),   μ = cosine of the angle by which light is deflected

μ = 1 is straight on: light goes forward for k > 0, back for k < 0, and evenly for k = 0. Its mean
cosine is 1/k - (1 - k²)/(2k²) ln((1 + k)/(1 - k)), about 2k/3 for small k; the usual
k = 1.55 g - 0.55 g³ makes it resemble Henyey-Greenstein's of the mean cosine g, although its own
mean cosine differs. |k| < 1, which that formula leaves for |g| > 0.938.

Use it where Henyey-Greenstein's power costs too much; Mitsuba's own `hg` is the exact one, its own
`rayleigh` is that of air, and `blendphase` mixes any two.

[Blasi et al. 1993]; its inverse distribution function is exact.
"""

import drjit as dr

from brdfkit.mitsuba_bridge.phase_functions import deflection
from brdfkit.mitsuba_bridge.properties.declarations import number

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

    class Schlick(deflection(mi, PARAMETERS)):
        def density(self, mu):
            return density(self.k, mu)

        def cosine(self, lobe, u):
            return cosine(self.k, u)

    return Schlick
