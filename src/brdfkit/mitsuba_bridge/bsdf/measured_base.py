"""The base class of a measurement's BSDF plugin: one component, drawn by one `Sampling`."""

from dataclasses import dataclass
from typing import Any

from brdfkit.core.geometry.vectors import mask_below_horizon
from brdfkit.mitsuba_bridge.bsdf.base import COSINE, COSINE_SHARE, define_frame


def define_measured_frame(mi):
    """The base class of a measurement's plugins in the current variant.

    A derived class calls `draw_by` in its constructor and defines

    - `brdf(wi, wo, si)`: the BRDF in sr⁻¹;
    - `albedo(wi, si)`: the share of the light from `wi` that is reflected. It stands for the
      diffuse reflectance (as in an albedo image), because nobody can tell which part of a
      measurement is diffuse.
    """
    import drjit as dr

    flags = mi.BSDFFlags

    class MeasuredFrame(define_frame(mi)):
        def draw_by(self, sampling, anisotropic, cosine_share=COSINE_SHARE):
            """Draw by a `brdfkit.model.lobes.Sampling`, a share of the samples by the cosine."""
            self.sampling, self.cosine_share = sampling, cosine_share
            azimuth = flags.Anisotropic if anisotropic else flags.Empty
            self.m_components = [flags.GlossyReflection | flags.FrontSide | azimuth]
            self.m_flags = self.m_components[0]

        def at(self, ctx, si, wi, active):
            return Point(mi, self, si, wi, ctx.is_enabled(flags.GlossyReflection, 0))

        def eval_diffuse_reflectance(self, si, active=True):
            wi, active = mask_below_horizon(si.wi, active)
            return mi.Spectrum(dr.select(active, self.albedo(wi, si), 0))

    return MeasuredFrame


@dataclass(frozen=True, eq=False)
class Point:
    """A measurement at a point, seen from `wi`; `enabled`: whether the context asks for it."""

    mi: Any
    bsdf: Any
    si: Any
    wi: Any
    enabled: bool

    def draw(self, sample1, sample2):
        """An outgoing direction, and the number of the only component."""
        import drjit as dr

        share = self.bsdf.cosine_share
        # What the choice leaves of sample1 is a third random number, as even as sample2
        u = self.mi.Point3f(sample2.x, sample2.y, dr.maximum(sample1 - share, 0) / (1 - share))
        by_cosine, by_itself = COSINE.sample(self.wi, u), self.bsdf.sampling.sample(self.wi, u)
        wo = dr.select(sample1 < share, by_cosine, by_itself)
        return wo, self.mi.UInt32(0)

    def pdf(self, wo):
        """Density of `draw` per solid angle."""
        if not self.enabled:
            return self.mi.Float(0)
        share = self.bsdf.cosine_share
        pdf = share * COSINE.pdf(self.wi, wo)
        return pdf + (1 - share) * self.bsdf.sampling.pdf(self.wi, wo)

    def value(self, wo):
        """BRDF [sr⁻¹], 0 if not enabled."""
        if not self.enabled:
            return self.mi.UnpolarizedSpectrum(0)
        return self.bsdf.brdf(self.wi, wo, self.si)
