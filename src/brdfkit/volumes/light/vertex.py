"""`Vertex`: the points where paths of light turn, each in a medium or on a surface."""

from dataclasses import dataclass
from typing import Any

import drjit as dr

from brdfkit.core.array_types import JitColour, JitFloat, JitMask, JitVector, MitsubaObject

replace_grad: Any = dr.replace_grad  # Dr.Jit's stub knows no result of it


@dataclass(eq=False)
class Vertex:
    """The points where rays are scattered: by a `phase` function in a medium, or by a BSDF.

    `in_medium` and `on_surface` are masks of the rays, `mei` and `si` their
    `mi.MediumInteraction3f` and `mi.SurfaceInteraction3f`.
    """

    phase: Any
    mei: Any
    in_medium: Any
    si: Any
    on_surface: Any

    @property
    def active(self) -> JitMask:
        """Whether light is scattered at all."""
        return self.in_medium | self.on_surface

    @property
    def interaction(self) -> MitsubaObject:
        """The `mi.Interaction3f` from which rays are sent."""
        import mitsuba as mi

        it = dr.zeros(mi.Interaction3f)
        it.p, it.n = self.either(self.mei.p, self.si.p), self.either(0, self.si.n)
        it.time, it.wavelengths = self.mei.time, self.mei.wavelengths
        return it

    def eval_pdf(self, wo: JitVector) -> tuple[JitColour, JitFloat]:
        """Return the share of light scattered towards `wo`, cosine included, and its density."""
        import mitsuba as mi

        phase = self.phase.eval_pdf(mi.PhaseFunctionContext(), self.mei, wo, self.in_medium)
        bsdf = self.si.bsdf().eval_pdf(
            mi.BSDFContext(), self.si, self.si.to_local(wo), self.on_surface
        )
        values = (mi.unpolarized_spectrum(value) for value in (phase[0], bsdf[0]))
        return self.either(*values), self.either(phase[1], bsdf[1])

    def sample(self, sampler: MitsubaObject) -> tuple[JitVector, JitColour, JitFloat]:
        """Return a direction, its weight, and its density, 0 if samples of emitters cannot find it.

        The weight has derivatives; the direction and the density have none.
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
        return wo, replace_grad(weight, attached), dr.select(smooth, pdf, 0)

    def either(self, in_medium: Any, on_surface: Any) -> Any:
        """Select one of two values, for rays in the medium or on a surface."""
        return dr.select(self.in_medium, in_medium, on_surface)


def medium_interaction(ray: MitsubaObject, t: JitFloat) -> MitsubaObject:
    """Return the `mi.MediumInteraction3f` of rays at the distance `t`."""
    import mitsuba as mi

    mei = dr.zeros(mi.MediumInteraction3f)
    mei.t, mei.p, mei.time, mei.wavelengths = t, ray(t), ray.time, ray.wavelengths
    mei.wi, mei.sh_frame = -ray.d, mi.Frame3f(-ray.d)
    return mei
