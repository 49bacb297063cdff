"""`Vertex`: points at which paths of light are scattered, each in a medium or on a surface."""

from dataclasses import dataclass
from typing import Any

import drjit as dr

from brdfkit.core.array_types import JitColour, JitFloat, JitMask, JitVector, MitsubaObject
from brdfkit.core.jit.gradients import replace_grad


@dataclass(eq=False)
class Vertex:
    """The points at which rays are scattered, by a phase function in a medium or by a BSDF.

    `in_medium` and `on_surface` are masks of the rays that are scattered there. `phase` is the
    medium's phase function, `mei` the `mi.MediumInteraction3f` in the medium, and `si` the
    `mi.SurfaceInteraction3f` on the surface.
    """

    phase: Any
    mei: Any
    in_medium: Any
    si: Any
    on_surface: Any

    @property
    def active(self) -> JitMask:
        """A mask of the rays that are scattered, in the medium or on a surface."""
        return self.in_medium | self.on_surface

    @property
    def interaction(self) -> MitsubaObject:
        """The points as a `mi.Interaction3f`, from which shadow rays start."""
        import mitsuba as mi

        it = dr.zeros(mi.Interaction3f)
        it.p = self.select_medium_or_surface(self.mei.p, self.si.p)
        it.n = self.select_medium_or_surface(0, self.si.n)
        it.time, it.wavelengths = self.mei.time, self.mei.wavelengths
        return it

    def eval_pdf(self, wo: JitVector) -> tuple[JitColour, JitFloat]:
        """Evaluate the phase function, or BSDF × cosine, for the direction `wo`, and its density.

        The density is that with which `sample_direction` draws `wo`, per solid angle.
        """
        import mitsuba as mi

        phase = self.phase.eval_pdf(mi.PhaseFunctionContext(), self.mei, wo, self.in_medium)
        bsdf = self.si.bsdf().eval_pdf(
            mi.BSDFContext(), self.si, self.si.to_local(wo), self.on_surface
        )
        values = (mi.unpolarized_spectrum(value) for value in (phase[0], bsdf[0]))
        return self.select_medium_or_surface(*values), self.select_medium_or_surface(
            phase[1], bsdf[1]
        )

    def sample_direction(self, sampler: MitsubaObject) -> tuple[JitVector, JitColour, JitFloat]:
        """Draw a scattered direction; return it with its weight and its density.

        The weight is the scattered share of light over the density, and has derivatives; the
        direction and the density have none. The density is 0 where sampling emitters cannot find
        the same light, as in a mirror.
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
            wo = self.select_medium_or_surface(wo, self.si.to_world(bs.wo))
            pdf = self.select_medium_or_surface(pdf, bs.pdf)
            drawn = self.active & (pdf > 0)
            weights = (mi.unpolarized_spectrum(w) for w in (weight, weight_of_bsdf))
            weight = dr.select(drawn, self.select_medium_or_surface(*weights), 0)
        value, _ = self.eval_pdf(wo)
        smooth = drawn & ~delta
        attached = dr.select(smooth, value / dr.select(smooth, pdf, 1), weight)
        return wo, replace_grad(weight, attached), dr.select(smooth, pdf, 0)

    def select_medium_or_surface(self, in_medium: Any, on_surface: Any) -> Any:
        """Select the first value for rays in the medium, and the second on a surface."""
        return dr.select(self.in_medium, in_medium, on_surface)


def make_medium_interaction(ray: MitsubaObject, t: JitFloat) -> MitsubaObject:
    """Return the `mi.MediumInteraction3f` at the distance `t` along rays."""
    import mitsuba as mi

    mei = dr.zeros(mi.MediumInteraction3f)
    mei.t, mei.p, mei.time, mei.wavelengths = t, ray(t), ray.time, ray.wavelengths
    mei.wi, mei.sh_frame = -ray.d, mi.Frame3f(-ray.d)
    return mei
