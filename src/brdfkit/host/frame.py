"""The methods of a Mitsuba BSDF, written once: a plugin says how it is at a point of a surface.

What they share: directions below the horizon are masked, directions are drawn without derivatives,
a share of the samples follows the cosine, so that the weight of a sample stays bounded where the
BRDF is, and values are unpolarised.
"""

from brdfkit.geometry.vectors import above_horizon
from brdfkit.model.lobes import Cosine

# Share of the samples that follow the cosine, whatever the BRDF
COSINE_SHARE = 0.1
COSINE = Cosine()


def frame(mi):
    """The base class of brdfkit's BSDFs in the current variant.

    A plugin that is derived from it defines `at(ctx, si, wi, active)`, the BSDF at a point, seen
    from `wi`: an object with

    - `draw(sample1, sample2)`: an outgoing direction and the number of its component;
    - `pdf(wo)`: the density of `draw`, per solid angle;
    - `value(wo)`: the BRDF of the components that the context asks for.

    It sets `m_components`, of which `draw` gives numbers, and `m_flags`.
    """
    import drjit as dr

    class Frame(mi.BSDF):
        def sample(self, ctx, si, sample1, sample2, active=True):
            wi, active = above_horizon(si.wi, active)
            here = self.at(ctx, si, wi, active)
            wo, component = here.draw(sample1, sample2)

            # Directions are drawn without derivatives, and so is their density in the weight
            wo = dr.detach(wo)
            sample = dr.zeros(mi.BSDFSample3f)
            above_wo, active = above_horizon(wo, active)
            value, pdf = here.value(above_wo) * above_wo.z, here.pdf(above_wo)
            active &= pdf > 0
            sample.wo = wo
            sample.pdf = dr.select(active, pdf, 0)
            sample.eta = 1.0
            sample.sampled_component = component
            sample.sampled_type = self.kind_of(component)
            pdf = dr.select(active, pdf, 1)
            weight = dr.select(active, value / dr.detach(pdf), 0)
            return sample, mi.depolarizer(weight)

        def eval_pdf(self, ctx, si, wo, active=True):
            wi, active = above_horizon(si.wi, active)
            wo, active = above_horizon(wo, active)
            here = self.at(ctx, si, wi, active)
            value, pdf = here.value(wo) * wo.z, here.pdf(wo)
            return mi.depolarizer(dr.select(active, value, 0)), dr.select(active, pdf, 0)

        def eval(self, ctx, si, wo, active=True):
            return self.eval_pdf(ctx, si, wo, active)[0]

        def pdf(self, ctx, si, wo, active=True):
            return self.eval_pdf(ctx, si, wo, active)[1]

        def kind_of(self, component):
            """Mitsuba's flag of a component, without what is said of its place."""
            kinds = [int(c) & int(mi.BSDFFlags.Reflection) for c in self.m_components]
            kind = mi.UInt32(kinds[0])
            for k, other in enumerate(kinds[1:], 1):
                kind = dr.select(component == k, other, kind)
            return kind

    return Frame
