"""BSDF as phase function: a volume that scatters light like a surface where its density changes.

    p(x, ωi, ωo) = f(ωi, ωo) |n·ωo|,   n = -∇ρ / |∇ρ|

f is a BSDF, ωi and ωo are the directions of light. n is the normal of the surface of equal density
ρ through the point x, and points to smaller densities. The gradient is computed by central
differences over one voxel of the grid to each side. Where it is 0, light is scattered evenly in all
directions. A BSDF that does not transmit scatters on both sides of the surface of equal density.

CT scans of skin and bone get highlights in this way, without extracting a surface. p integrates to
the albedo of the BSDF, at most 1, and a medium scatters its own albedo times this: give the colour
to one of the two albedos, and 1 to the other. p is not reciprocal, because of the cosine.
Directions are drawn as the BSDF draws them. Textures are read at u = v = 0. Tangents are arbitrary,
so an anisotropic BSDF has no use. A mirror, which reflects light into a single direction, is
refused.

[Lesar 2018, eq. 4.57].
"""

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
from brdfkit.core.errors import BrdfkitError
from brdfkit.mitsuba_bridge.properties.declarations import (
    declare_bsdf,
    declare_volume,
    derive_plugin,
)

PARAMETERS = {
    "bsdf": declare_bsdf("f, by default white and matte; in a scene file it needs this name"),
    "density": declare_volume(1.0, "ρ, which has the gradient: the same grid as the medium's"),
}
# Changes of the density ρ that are below this share of ρ count as rounding errors
ROUNDING = 1e-5


def define(mi: MitsubaModule) -> type:
    """Return the plugin's class for Mitsuba's current variant: a `mi.PhaseFunction`."""
    Base: MitsubaObject = derive_plugin(mi.PhaseFunction, PARAMETERS)

    class BsdfPhase(Base):
        def __init__(self, props: MitsubaObject) -> None:
            super().__init__(props)
            flags, has = self.bsdf.flags(), mi.has_flag
            if has(flags, mi.BSDFFlags.Delta):
                raise BrdfkitError(
                    f"{props.plugin_name()}: the bsdf reflects or transmits in single directions; "
                    "give a rough one."
                )
            self.m_flags = mi.PhaseFunctionFlags.Anisotropic
            self.one_sided = not has(flags, mi.BSDFFlags.Transmission)
            # Refraction scales radiance, but within a medium the refractive index is 1
            self.context = mi.BSDFContext(mi.TransportMode.Importance)
            box, cells = self.density.bbox(), self.density.resolution()
            self.voxel = [box.extents()[i] / cells[i] for i in range(3)]

        def sample(
            self,
            ctx: MitsubaObject,
            interaction: MitsubaObject,
            sample1: JitFloat,
            sample2: JitVector,
            active: JitMask = True,
        ) -> tuple[JitVector, JitColour, JitFloat]:
            si, there = self.make_surface_interaction(interaction, active)
            drawn, _ = self.bsdf.sample(self.context, si, sample1, sample2, active & there)
            lost = there & (drawn.pdf <= 0)  # the BSDF drew no direction, or one below the surface
            even = mi.warp.square_to_uniform_sphere(sample2)
            # Neither the direction nor its density in the weight has derivatives
            wo = dr.detach(dr.select(drawn.pdf > 0, si.to_world(drawn.wo), even))
            value, pdf = self.eval_pdf(ctx, interaction, wo, active)
            weight = value / dr.detach(dr.select(pdf > 0, pdf, 1))  # where pdf is 0, value is 0
            return wo, dr.select(lost, 0, weight), dr.select(lost, 0, pdf)

        def eval_pdf(
            self,
            ctx: MitsubaObject,
            interaction: MitsubaObject,
            wo: JitVector,
            active: JitMask = True,
        ) -> tuple[JitColour, JitFloat]:
            si, there = self.make_surface_interaction(interaction, active)
            value, pdf = self.bsdf.eval_pdf(self.context, si, si.to_local(wo), active & there)
            value, even = mi.unpolarized_spectrum(value), 1 / (4 * dr.pi)
            return mi.depolarizer(dr.select(there, value, even)), dr.select(there, pdf, even)

        def make_surface_interaction(
            self, interaction: MitsubaObject, active: JitMask
        ) -> tuple[MitsubaObject, JitMask]:
            """Return an interaction on the surface of equal density through a point, and a mask.

            The mask is False where the density is constant, so that there is no surface.
            """
            gradient, there = self.density_gradient(interaction, active)
            n = dr.normalize(dr.select(there, -gradient, mi.Vector3f(0, 0, 1)))
            if self.one_sided:
                n = dr.mulsign(n, dr.dot(n, interaction.wi))
            si = mi.SurfaceInteraction3f()
            si.p, si.time, si.wavelengths = interaction.p, interaction.time, interaction.wavelengths
            si.n, si.sh_frame, si.uv = n, mi.Frame3f(n), mi.Point2f(0)
            si.wi = si.to_local(interaction.wi)
            return si, there

        def density_gradient(
            self, interaction: MitsubaObject, active: JitMask
        ) -> tuple[JitVector, JitMask]:
            """Return the gradient ∇ρ of the density, and whether it exceeds rounding errors."""
            it = mi.Interaction3f()
            it.time, it.wavelengths = interaction.time, interaction.wavelengths
            change, total = mi.Vector3f(0), mi.Float(0)
            for axis, h in enumerate(self.voxel):
                ends = []
                for sign in (-1, 1):
                    step = mi.Vector3f(0)
                    step[axis] = sign * h
                    it.p = interaction.p + step
                    ends.append(self.density.eval_1(it, active))
                low, high = ends
                change[axis] = (high - low) / (2 * h)
                total += (high + low) / (2 * h)
            return change, dr.norm(change) > ROUNDING * total

    return BsdfPhase


def example() -> dict[str, Any]:
    """Return a phase function of a white BSDF in a density that falls along z, to test it."""
    import mitsuba as mi
    import numpy as np

    ramp = np.linspace(1, 0, 8, dtype=np.float32).reshape(8, 1, 1, 1)
    cube = mi.ScalarTransform4f().translate(-0.5)
    density = {"type": "gridvolume", "grid": mi.VolumeGrid(ramp), "to_world": cube}
    return {"type": "bsdf_phase", "density": density}
