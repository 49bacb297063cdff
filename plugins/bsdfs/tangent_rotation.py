"""Tangent rotation: an anisotropic material, such as brushed metal, turned by a texture of angles.

    {"type": "tangent_rotation", "angle": {"type": "bitmap", ...}, "bsdf": {"type": "ward", ...}}

The material may be any BSDF of Mitsuba or brdfkit. It is turned about the normal by the `angle`:
its width `alpha_u` applies along the turned u axis. A `normalmap` around the plugin gives the
normal.
"""

from typing import Any

from brdfkit.core.array_types import (
    JitColour,
    JitFloat,
    JitMask,
    JitVector,
    MitsubaModule,
    MitsubaObject,
)
from brdfkit.mitsuba_bridge.properties.declarations import (
    declare_bsdf,
    declare_texture,
    derive_plugin,
)

PARAMETERS = {
    "angle": declare_texture(
        0.0, "from the surface's u axis to the material's, counterclockwise [rad]"
    ),
    "bsdf": declare_bsdf("the material to turn; in a scene file it needs this name"),
}


def define(mi: MitsubaModule) -> type:
    """Return the plugin's class for Mitsuba's current variant: a `mi.BSDF`."""
    import drjit as dr

    from brdfkit.core.jit.gradients import replace_grad

    Base: MitsubaObject = derive_plugin(mi.BSDF, PARAMETERS)

    class TangentRotation(Base):
        def __init__(self, props: MitsubaObject) -> None:
            super().__init__(props)
            count = self.bsdf.component_count()
            self.m_components = [self.bsdf.flags(k) for k in range(count)]
            self.m_flags = self.bsdf.flags()

        def turn_interaction(
            self, si: MitsubaObject, active: JitMask
        ) -> tuple[MitsubaObject, JitFloat, JitFloat]:
            """Return `si` in the turned material's frame, and the cosine and sine of the angle."""
            sine, cosine = dr.sincos(self.angle.eval_1(si, active))
            inside = mi.SurfaceInteraction3f(si)
            inside.wi = turn_direction(si.wi, cosine, -sine)
            return inside, cosine, sine

        def sample(
            self,
            ctx: MitsubaObject,
            si: MitsubaObject,
            sample1: JitFloat,
            sample2: JitVector,
            active: JitMask = True,
        ) -> tuple[MitsubaObject, JitColour]:
            inside, cosine, sine = self.turn_interaction(si, active)
            drawn, weight = self.bsdf.sample(ctx, inside, sample1, sample2, active)
            drawn.wo = dr.detach(turn_direction(drawn.wo, cosine, sine))
            if not dr.is_diff_v(mi.Float):  # plain numbers
                return drawn, weight
            # The drawn direction has no derivatives: it stays fixed while the material turns
            smooth = active & (drawn.pdf > 0) & mi.has_flag(drawn.sampled_type, mi.BSDFFlags.Smooth)
            value = self.bsdf.eval(ctx, inside, turn_direction(drawn.wo, cosine, -sine), smooth)
            pdf = dr.select(smooth, dr.detach(drawn.pdf), 1)
            return drawn, dr.select(smooth, replace_grad(weight, value / pdf), weight)

        def eval(
            self, ctx: MitsubaObject, si: MitsubaObject, wo: JitVector, active: JitMask = True
        ) -> JitColour:
            inside, cosine, sine = self.turn_interaction(si, active)
            return self.bsdf.eval(ctx, inside, turn_direction(wo, cosine, -sine), active)

        def pdf(
            self, ctx: MitsubaObject, si: MitsubaObject, wo: JitVector, active: JitMask = True
        ) -> JitFloat:
            inside, cosine, sine = self.turn_interaction(si, active)
            return self.bsdf.pdf(ctx, inside, turn_direction(wo, cosine, -sine), active)

        def eval_pdf(
            self, ctx: MitsubaObject, si: MitsubaObject, wo: JitVector, active: JitMask = True
        ) -> tuple[JitColour, JitFloat]:
            inside, cosine, sine = self.turn_interaction(si, active)
            return self.bsdf.eval_pdf(ctx, inside, turn_direction(wo, cosine, -sine), active)

        def eval_diffuse_reflectance(self, si: MitsubaObject, active: JitMask = True) -> JitColour:
            return self.bsdf.eval_diffuse_reflectance(self.turn_interaction(si, active)[0], active)

    def turn_direction(w: JitVector, cosine: JitFloat, sine: JitFloat) -> JitVector:
        """Return the direction `w`, turned about the normal (z) counterclockwise."""
        return mi.Vector3f(cosine * w.x - sine * w.y, sine * w.x + cosine * w.y, w.z)

    return TangentRotation


def example() -> dict[str, Any]:
    """Return a BSDF of brushed metal, turned by 0.5 rad, to test the plugin."""
    brushed = {"type": "ward", "alpha_u": 0.4, "alpha_v": 0.1, "specular_reflectance": 0.5}
    return {"type": "tangent_rotation", "angle": 0.5, "bsdf": brushed}
