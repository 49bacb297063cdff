"""`Vertex`: where paths of light turn, in a medium or on a surface, each ray's its own."""

from dataclasses import dataclass
from typing import Any

import drjit as dr


@dataclass(eq=False)
class Vertex:
    """Where rays were scattered: by a phase function where `in_medium`, by a BSDF `on_surface`.

    mei, si : the `mi.MediumInteraction3f` and the `mi.SurfaceInteraction3f`.
    """

    phase: Any
    mei: Any
    in_medium: Any
    si: Any
    on_surface: Any

    @property
    def active(self):
        """Whether light is scattered at all."""
        return self.in_medium | self.on_surface

    @property
    def interaction(self):
        """The place, from which rays are sent."""
        import mitsuba as mi

        it = dr.zeros(mi.Interaction3f)
        it.p, it.n = self.either(self.mei.p, self.si.p), self.either(0, self.si.n)
        it.time, it.wavelengths = self.mei.time, self.mei.wavelengths
        return it

    def eval_pdf(self, wo):
        """The light that is scattered into `wo`, with a surface's cosine, and its density."""
        import mitsuba as mi

        phase = self.phase.eval_pdf(mi.PhaseFunctionContext(), self.mei, wo, self.in_medium)
        bsdf = self.si.bsdf().eval_pdf(
            mi.BSDFContext(), self.si, self.si.to_local(wo), self.on_surface
        )
        values = (mi.unpolarized_spectrum(value) for value in (phase[0], bsdf[0]))
        return self.either(*values), self.either(phase[1], bsdf[1])

    def sample(self, sampler):
        """A direction, its weight, and its density: 0 where no other way finds that direction.

        The weight has the derivatives of what is scattered, the direction and the density none.
        """
        import mitsuba as mi

        with dr.suspend_grad():
            u, v = sampler.next_1d(self.active), sampler.next_2d(self.active)
            wo, weight, pdf = self.phase.sample(
                mi.PhaseFunctionContext(), self.mei, u, v, self.in_medium
            )
            bs, weight_of_bsdf = self.si.bsdf().sample(
                mi.BSDFContext(), self.si, u, v, self.on_surface
            )
            delta = self.on_surface & mi.has_flag(bs.sampled_type, mi.BSDFFlags.Delta)
            wo = self.either(wo, self.si.to_world(bs.wo))
            pdf = self.either(pdf, bs.pdf)
            drawn = self.active & (pdf > 0)
            weights = (mi.unpolarized_spectrum(w) for w in (weight, weight_of_bsdf))
            weight = dr.select(drawn, self.either(*weights), 0)
        value, _ = self.eval_pdf(wo)
        smooth = drawn & ~delta
        attached = dr.select(smooth, value / dr.select(smooth, pdf, 1), weight)
        return wo, dr.replace_grad(weight, attached), dr.select(smooth, pdf, 0)

    def either(self, in_medium, on_surface):
        return dr.select(self.in_medium, in_medium, on_surface)


def medium_interaction(ray, t):
    """The `mi.MediumInteraction3f` of rays at t."""
    import mitsuba as mi

    mei = dr.zeros(mi.MediumInteraction3f)
    mei.t, mei.p, mei.time, mei.wavelengths = t, ray(t), ray.time, ray.wavelengths
    mei.wi, mei.sh_frame = -ray.d, mi.Frame3f(-ray.d)
    return mei
