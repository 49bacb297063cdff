"""The base class of a measurement's BSDF plugin, which has one component and one `Sampling`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from brdfkit.core.array_types import (
    JitColour,
    JitFloat,
    JitInt,
    JitMask,
    JitVector,
    MitsubaModule,
    MitsubaObject,
)
from brdfkit.core.geometry.vectors import mask_below_horizon
from brdfkit.mitsuba_bridge.bsdf.base import COSINE, COSINE_SHARE, define_base_bsdf
from brdfkit.model.lobes import Sampling


def define_measured_bsdf(mi: MitsubaModule) -> Any:
    """Define the base class of a measurement's plugins in the current variant.

    A derived class calls `set_sampling` in its constructor and defines

    - `brdf(wi, wo, si)`: the BRDF in sr⁻¹;
    - `albedo(wi, si)`: the share of the light from `wi` that is reflected. It stands for the
      diffuse reflectance (as in an albedo image), because nobody can tell which part of a
      measurement is diffuse.
    """
    import drjit as dr

    flags = mi.BSDFFlags
    Base: Any = define_base_bsdf(mi)

    class MeasuredBsdf(Base):
        def set_sampling(
            self, sampling: Sampling, anisotropic: bool, cosine_share: float = COSINE_SHARE
        ) -> None:
            """Set the `Sampling` of directions, and the share of samples that follow the cosine."""
            self.sampling, self.cosine_share = sampling, cosine_share
            azimuth = flags.Anisotropic if anisotropic else flags.Empty
            self.m_components = [flags.GlossyReflection | flags.FrontSide | azimuth]
            self.m_flags = self.m_components[0]

        def make_response(
            self, ctx: MitsubaObject, si: MitsubaObject, wi: JitVector, active: JitMask
        ) -> Point:
            return Point(mi, self, si, wi, ctx.is_enabled(flags.GlossyReflection, 0))

        def eval_diffuse_reflectance(self, si: MitsubaObject, active: JitMask = True) -> JitColour:
            wi, active = mask_below_horizon(si.wi, active)
            return mi.Spectrum(dr.select(active, self.albedo(wi, si), 0))

    return MeasuredBsdf


@dataclass(frozen=True, eq=False)
class Point:
    """A measured BRDF `bsdf` at a surface point `si`, for light from `wi`.

    `mi` is Mitsuba; `enabled` says whether its context asks for the BSDF's only component.
    """

    mi: Any
    bsdf: Any
    si: Any
    wi: Any
    enabled: bool

    def draw_direction(self, sample1: JitFloat, sample2: JitVector) -> tuple[JitVector, JitInt]:
        """Draw an outgoing direction; return it with the number of the only component."""
        import drjit as dr

        share = self.bsdf.cosine_share
        # What is left of sample1 after the choice is a third uniform random number
        u = self.mi.Point3f(sample2.x, sample2.y, dr.maximum(sample1 - share, 0) / (1 - share))
        by_cosine, by_itself = COSINE.sample(self.wi, u), self.bsdf.sampling.sample(self.wi, u)
        wo = dr.select(sample1 < share, by_cosine, by_itself)
        return wo, self.mi.UInt32(0)

    def pdf(self, wo: JitVector) -> JitFloat:
        """Return the density of `draw_direction` per solid angle."""
        if not self.enabled:
            return self.mi.Float(0)
        share = self.bsdf.cosine_share
        pdf = share * COSINE.pdf(self.wi, wo)
        return pdf + (1 - share) * self.bsdf.sampling.pdf(self.wi, wo)

    def evaluate_brdf(self, wo: JitVector) -> JitColour:
        """Return the BRDF [sr⁻¹], 0 if not enabled."""
        if not self.enabled:
            return self.mi.UnpolarizedSpectrum(0)
        return self.bsdf.brdf(self.wi, wo, self.si)
