"""BSDF as phase function: a volume that scatters light as surfaces do, where its density changes.

    p(x, ωi, ωo) = f(ωi, ωo) |n·ωo|,   n = -∇ρ / |∇ρ|

n is the normal of the surface of equal density ρ through x, towards where ρ falls. The gradient is
by central differences over one voxel of the grid each way; where it vanishes, light is scattered
evenly. A BSDF that does not transmit scatters on both sides of that surface.

It shows skin and bone of CT scans with highlights, without a surface to cut out. p integrates to
the BSDF's albedo, at most 1, and what a medium scatters is its own albedo times that: give the
colour to one of them, and 1 to the other. The exchange of ωi and ωo changes p, by their cosines.
Directions are drawn as the BSDF draws them. Textures are read at u = v = 0; tangents point
anywhere, so an anisotropic BSDF has no use; a mirror, whose light leaves in one direction, is
refused.

[Lesar 2018, eq. 4.57].
"""

import drjit as dr

from brdfkit.core.errors import BrdfkitError
from brdfkit.mitsuba_bridge.properties.declarations import bsdf, declared, volume

PARAMETERS = {
    "bsdf": bsdf("f, by default white and matte; in a scene file name it so"),
    "density": volume(1.0, "ρ, whose gradient counts: the medium's grid, given here again"),
}
LEAST = 1e-5  # of a change of ρ, relative to ρ: less is rounding


def define(mi):
    """The class of `mi.PhaseFunction` for the current variant."""

    class BsdfPhase(declared(mi.PhaseFunction, PARAMETERS)):
        def __init__(self, props):
            super().__init__(props)
            flags, has = self.bsdf.flags(), mi.has_flag
            if has(flags, mi.BSDFFlags.Delta):
                raise BrdfkitError(
                    f"{props.plugin_name()}: the bsdf reflects or transmits in single directions; "
                    "give a rough one."
                )
            self.m_flags = mi.PhaseFunctionFlags.Anisotropic
            self.one_sided = not has(flags, mi.BSDFFlags.Transmission)
            # refraction scales radiance, but within a medium the refractive index is one
            self.context = mi.BSDFContext(mi.TransportMode.Importance)
            box, cells = self.density.bbox(), self.density.resolution()
            self.voxel = [box.extents()[i] / cells[i] for i in range(3)]

        def sample(self, ctx, interaction, sample1, sample2, active=True):
            si, there = self.surface(interaction, active)
            drawn, _ = self.bsdf.sample(self.context, si, sample1, sample2, active & there)
            lost = there & (drawn.pdf <= 0)  # below the surface, for instance
            even = mi.warp.square_to_uniform_sphere(sample2)
            # Neither the direction nor its density in the weight has derivatives
            wo = dr.detach(dr.select(drawn.pdf > 0, si.to_world(drawn.wo), even))
            value, pdf = self.eval_pdf(ctx, interaction, wo, active)
            weight = value / dr.detach(dr.select(pdf > 0, pdf, 1))  # the value is 0 where pdf is
            return wo, dr.select(lost, 0, weight), dr.select(lost, 0, pdf)

        def eval_pdf(self, ctx, interaction, wo, active=True):
            si, there = self.surface(interaction, active)
            value, pdf = self.bsdf.eval_pdf(self.context, si, si.to_local(wo), active & there)
            value, even = mi.unpolarized_spectrum(value), 1 / (4 * dr.pi)
            return mi.depolarizer(dr.select(there, value, even)), dr.select(there, pdf, even)

        def surface(self, interaction, active):
            """The surface of equal density, and whether there is one."""
            gradient, there = self.gradient(interaction, active)
            n = dr.normalize(dr.select(there, -gradient, mi.Vector3f(0, 0, 1)))
            if self.one_sided:
                n = dr.mulsign(n, dr.dot(n, interaction.wi))
            si = mi.SurfaceInteraction3f()
            si.p, si.time, si.wavelengths = interaction.p, interaction.time, interaction.wavelengths
            si.n, si.sh_frame, si.uv = n, mi.Frame3f(n), mi.Point2f(0)
            si.wi = si.to_local(interaction.wi)
            return si, there

        def gradient(self, interaction, active):
            """∇ρ, and whether it is more than rounding."""
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
            return change, dr.norm(change) > LEAST * total

    return BsdfPhase


def example():
    """A white BSDF in a density that falls along z, for the checks."""
    import mitsuba as mi
    import numpy as np

    ramp = np.linspace(1, 0, 8, dtype=np.float32).reshape(8, 1, 1, 1)
    cube = mi.ScalarTransform4f().translate(-0.5)
    density = {"type": "gridvolume", "grid": mi.VolumeGrid(ramp), "to_world": cube}
    return {"type": "bsdf_phase", "density": density}
