"""Phase functions of two equal halves: light scattered evenly, and a power about straight on."""

import drjit as dr

from brdfkit.mitsuba_bridge.phase_functions import deflection


def density(n, mu):
    """p(μ) = (1 + (n + 1) ((1 + μ) / 2)ⁿ) / 8π [sr⁻¹]."""
    return (1 + (n + 1) * (0.5 + 0.5 * mu) ** n) / (8 * dr.pi)


def cosine(n, lobe, u):
    """A μ of one of the halves, which `lobe` chooses: the one below which its share `u` lies."""
    return 2 * dr.select(lobe < 0.5, u, u ** (1 / (n + 1))) - 1


def even_and_forward(mi, n):
    """The class of `mi.PhaseFunction` with the power `n`."""

    class EvenAndForward(deflection(mi, {})):
        def density(self, mu):
            return density(n, mu)

        def cosine(self, lobe, u):
            return cosine(n, lobe, u)

    return EvenAndForward
