"""Mie, murky: light scattered by droplets, dense murk: half evenly, half about straight on.

    p(μ) = (1 + 33 ((1 + μ) / 2)³²) / 8π,   μ = cosine of the angle by which light is deflected

μ = 1 is straight on. Sampled exactly: one half is even in μ, of the other the distribution function
has an inverse. The mean cosine is 8/17.

[Nishita et al. 1987]; [Lesar 2018, eq. 4.63].
"""

from brdfkit.mitsuba_bridge.phase_functions import even_and_forward

PARAMETERS = {}
N = 32


def define(mi):
    """The class of `mi.PhaseFunction` for the current variant."""

    class MieMurky(even_and_forward(mi, N)):
        pass

    return MieMurky
