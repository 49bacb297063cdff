"""Mie, murky: the phase function of dense fog, which scatters half evenly and half forward.

    p(μ) = (1 + 33 ((1 + μ) / 2)³²) / 8π,   μ = cosine of the angle by which light is deflected

Light with μ = 1 goes straight on. Sampling is exact: one half is uniform in μ, and the cumulative
distribution of the other half can be inverted. The mean cosine is 8/17.

[Nishita et al. 1987]; [Lesar 2018, eq. 4.63].
"""

from typing import Any

from brdfkit.core.array_types import MitsubaModule, MitsubaObject
from brdfkit.mitsuba_bridge.phase_functions import define_even_and_forward

PARAMETERS: dict[str, Any] = {}
EXPONENT = 32


def define(mi: MitsubaModule) -> type:
    """Return the plugin's class for Mitsuba's current variant: a `mi.PhaseFunction`."""
    Base: MitsubaObject = define_even_and_forward(mi, EXPONENT)

    class MieMurky(Base):
        pass

    return MieMurky
