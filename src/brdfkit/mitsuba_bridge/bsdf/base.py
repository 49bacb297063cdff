"""The base class of brdfkit's BSDF plugins: the methods of `mi.BSDF`, written once for all.

Directions below the horizon are masked. Directions are drawn without derivatives. A share of the
samples follows the cosine, so that the weight of a sample is bounded where the BRDF is. Values are
unpolarised.
"""

from brdfkit.core.geometry.vectors import mask_below_horizon
from brdfkit.model.lobes import Cosine

# Share of the samples that follow the cosine, whatever the BRDF
COSINE_SHARE = 0.1
COSINE = Cosine()


def define_frame(mi):
    """The base class of brdfkit's BSDFs in the current variant.

    A derived class defines `at(ctx, si, wi, active)`, the BSDF at a point of a surface, seen from
    `wi`: an object with

    - `draw(sample1, sample2)`: an outgoing direction and the number of its component;
    - `pdf(wo)`: the density of `draw`, per solid angle;
    - `value(wo)`: the BRDF of the components that the context asks for.

    It sets `m_components`, to which the numbers of components refer, and `m_flags`.
    """
    import drjit as dr

    class Frame(mi.BSDF):
        def sample(self, ctx, si, sample1, sample2, active=True):
            wi, active = mask_below_horizon(si.wi, active)
            here = self.at(ctx, si, wi, active)
            wo, component = here.draw(sample1, sample2)

            # Neither the direction nor its density in the weight has derivatives
            wo = dr.detach(wo)
            sample = dr.zeros(mi.BSDFSample3f)
            above_wo, active = mask_below_horizon(wo, active)
            value, pdf = here.value(above_wo) * above_wo.z, here.pdf(above_wo)
            active &= pdf > 0
            sample.wo = wo
            sample.pdf = dr.select(active, pdf, 0)
            sample.eta = 1.0
            sample.sampled_component = component
            sample.sampled_type = self.find_kind(component)
            pdf = dr.select(active, pdf, 1)
            weight = dr.select(active, value / dr.detach(pdf), 0)
            return sample, mi.depolarizer(weight)

        def eval_pdf(self, ctx, si, wo, active=True):
            wi, active = mask_below_horizon(si.wi, active)
            wo, active = mask_below_horizon(wo, active)
            here = self.at(ctx, si, wi, active)
            value, pdf = here.value(wo) * wo.z, here.pdf(wo)
            return mi.depolarizer(dr.select(active, value, 0)), dr.select(active, pdf, 0)

        def eval(self, ctx, si, wo, active=True):
            return self.eval_pdf(ctx, si, wo, active)[0]

        def pdf(self, ctx, si, wo, active=True):
            return self.eval_pdf(ctx, si, wo, active)[1]

        def find_kind(self, component):
            """Mitsuba's kind of reflection of a component: its flag without side and anisotropy."""
            kinds = [int(c) & int(mi.BSDFFlags.Reflection) for c in self.m_components]
            kind = mi.UInt32(kinds[0])
            for k, other in enumerate(kinds[1:], 1):
                kind = dr.select(component == k, other, kind)
            return kind

    return Frame
