"""Schlick: a phase function close to Henyey-Greenstein's, which needs no power.

    p(μ) = (1 - k²) / (4π (1 - kμ)²),   μ = cosine of the angle by which light is deflected

Light with μ = 1 goes straight on: most goes forward for k > 0 and back for k < 0, and it goes
evenly in all directions for k = 0. The mean cosine is 1/k - (1 - k²)/(2k²) ln((1 + k)/(1 - k)),
about 2k/3 for small k. With the common choice k = 1.55 g - 0.55 g³ the function resembles
Henyey-Greenstein's with the mean cosine g, although its own mean cosine differs. |k| has to be
below 1, which this formula exceeds for |g| > 0.938.

Use it where the power in Henyey-Greenstein's function costs too much. Mitsuba itself has
Henyey-Greenstein's function as `hg`, the phase function of air as `rayleigh`, and `blendphase`,
which mixes any two.

[Blasi et al. 1993]; directions are drawn exactly, by the inverse of the cumulative distribution.
"""

import drjit as dr

from brdfkit.core.array_types import JitFloat, MitsubaModule, MitsubaObject
from brdfkit.mitsuba_bridge.phase_functions import derive_phase_function
from brdfkit.mitsuba_bridge.properties.declarations import declare_number

PARAMETERS = {
    "k": declare_number(0.5, (-0.999, 0.999), "asymmetry: above 0 forward, below 0 back"),
}


def density(k: JitFloat, mu: JitFloat) -> JitFloat:
    """Return Schlick's phase function p(μ) [sr⁻¹] at the cosine `mu` of the deflection angle."""
    return (1 - k * k) / (4 * dr.pi * dr.square(1 - k * mu))


def draw_cosine(k: JitFloat, u: JitFloat) -> JitFloat:
    """Draw the cosine μ of the deflection angle by the uniform random number `u`."""
    return (2 * u + k - 1) / (2 * k * u - k + 1)


def define(mi: MitsubaModule) -> type:
    """Return the plugin's class for Mitsuba's current variant: a `mi.PhaseFunction`."""
    Base: MitsubaObject = derive_phase_function(mi, PARAMETERS)

    class Schlick(Base):
        def density(self, mu: JitFloat) -> JitFloat:
            return density(self.k, mu)

        def draw_cosine(self, lobe: JitFloat, u: JitFloat) -> JitFloat:
            return draw_cosine(self.k, u)

    return Schlick
