"""Base classes of phase functions that depend only on the scattering angle."""

from typing import Any

import drjit as dr

from brdfkit.core.array_types import (
    JitColour,
    JitFloat,
    JitMask,
    JitVector,
    MitsubaModule,
    MitsubaObject,
)
from brdfkit.mitsuba_bridge.properties.declarations import derive_plugin


def derive_phase_function(mi: MitsubaModule, parameters: dict[str, Any]) -> Any:
    """Return a class derived from `mi.PhaseFunction` with `parameters` as in `derive_plugin`.

    A derived class adds two methods: `density(mu)` returns the phase function p(μ) [sr⁻¹] at the
    cosine μ of the scattering angle, which is 1 straight ahead; `draw_cosine(lobe, u)` returns a
    random μ, from two uniform random numbers, 0 to 1.
    """

    Base: Any = derive_plugin(mi.PhaseFunction, parameters)

    class Deflection(Base):
        def __init__(self, props: MitsubaObject) -> None:
            super().__init__(props)
            self.m_flags = mi.PhaseFunctionFlags.Anisotropic

        def sample(
            self,
            ctx: MitsubaObject,
            interaction: MitsubaObject,
            sample1: JitFloat,
            sample2: JitVector,
            active: JitMask = True,
        ) -> tuple[JitVector, JitColour, JitFloat]:
            mu = self.draw_cosine(sample1, sample2.x)
            radius = dr.safe_sqrt(1 - mu * mu)
            sin_phi, cos_phi = dr.sincos(2 * dr.pi * sample2.y)
            local = mi.Vector3f(radius * cos_phi, radius * sin_phi, mu)
            # Neither the direction nor its density in the weight has derivatives
            wo = dr.detach(mi.Frame3f(-interaction.wi).to_world(local))
            value, pdf = self.eval_pdf(ctx, interaction, wo, active)
            return wo, value / dr.detach(pdf), pdf

        def eval_pdf(
            self,
            ctx: MitsubaObject,
            interaction: MitsubaObject,
            wo: JitVector,
            active: JitMask = True,
        ) -> tuple[JitColour, JitFloat]:
            pdf = self.density(-dr.dot(interaction.wi, wo))  # wi points back along the path
            return mi.Spectrum(pdf), pdf

    return Deflection


def even_and_forward_density(n: float, mu: JitFloat) -> JitFloat:
    """Return the phase function (1 + (n + 1) ((1 + μ) / 2)ⁿ) / 8π [sr⁻¹], μ = cos(deflection)."""
    return (1 + (n + 1) * (0.5 + 0.5 * mu) ** n) / (8 * dr.pi)


def draw_cosine(n: float, lobe: JitFloat, u: JitFloat) -> JitFloat:
    """Draw a cosine μ with the density of `even_and_forward_density`, by two random numbers.

    `lobe` chooses the uniform or the forward half of the density, and `u` the cosine from it.
    """
    return 2 * dr.select(lobe < 0.5, u, u ** (1 / (n + 1))) - 1


def define_even_and_forward(mi: MitsubaModule, n: float) -> Any:
    """Define a phase function that is half uniform and half forward with the power `n`."""

    Base: Any = derive_phase_function(mi, {})

    class EvenAndForward(Base):
        def density(self, mu: JitFloat) -> JitFloat:
            return even_and_forward_density(n, mu)

        def draw_cosine(self, lobe: JitFloat, u: JitFloat) -> JitFloat:
            return draw_cosine(n, lobe, u)

    return EvenAndForward
