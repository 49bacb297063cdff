"""The base class of brdfkit's BSDF plugins, which has the methods of `mi.BSDF` for all of them.

The value and the density are 0 for directions below the horizon. Directions are drawn without
derivatives. A share of the samples follows the cosine, so that the weight of a sample is bounded
wherever the BRDF is. Values are unpolarised.
"""

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
from brdfkit.model.lobes import Cosine

# The share of samples that are drawn in proportion to the cosine, whatever the BRDF
COSINE_SHARE = 0.1
COSINE = Cosine()


def define_base_bsdf(mi: MitsubaModule) -> Any:
    """Define the base class of brdfkit's BSDFs in the current variant.

    A derived class defines `make_response(ctx, si, wi, active)`, which returns the BSDF at a point
    of a surface for light from `wi`, as an object with

    - `draw_direction(sample1, sample2)`: an outgoing direction and the number of its component;
    - `pdf(wo)`: the density of `draw_direction`, per solid angle;
    - `evaluate_brdf(wo)`: the BRDF of the components that the context enables.

    It sets `m_components`, to which the numbers of components refer, and `m_flags`.
    """
    import drjit as dr

    class BaseBsdf(mi.BSDF):
        def sample(
            self,
            ctx: MitsubaObject,
            si: MitsubaObject,
            sample1: JitFloat,
            sample2: JitVector,
            active: JitMask = True,
        ) -> tuple[MitsubaObject, JitColour]:
            wi, active = mask_below_horizon(si.wi, active)
            here = self.make_response(ctx, si, wi, active)
            wo, component = here.draw_direction(sample1, sample2)

            # Neither the direction nor its density in the weight has derivatives
            wo = dr.detach(wo)
            sample = dr.zeros(mi.BSDFSample3f)
            above_wo, active = mask_below_horizon(wo, active)
            value, pdf = here.evaluate_brdf(above_wo) * above_wo.z, here.pdf(above_wo)
            active &= pdf > 0
            sample.wo = wo
            sample.pdf = dr.select(active, pdf, 0)
            sample.eta = 1.0
            sample.sampled_component = component
            sample.sampled_type = self.find_component_kind(component)
            pdf = dr.select(active, pdf, 1)
            weight = dr.select(active, value / dr.detach(pdf), 0)
            return sample, mi.depolarizer(weight)

        def eval_pdf(
            self, ctx: MitsubaObject, si: MitsubaObject, wo: JitVector, active: JitMask = True
        ) -> tuple[JitColour, JitFloat]:
            wi, active = mask_below_horizon(si.wi, active)
            wo, active = mask_below_horizon(wo, active)
            here = self.make_response(ctx, si, wi, active)
            value, pdf = here.evaluate_brdf(wo) * wo.z, here.pdf(wo)
            return mi.depolarizer(dr.select(active, value, 0)), dr.select(active, pdf, 0)

        def eval(
            self, ctx: MitsubaObject, si: MitsubaObject, wo: JitVector, active: JitMask = True
        ) -> JitColour:
            return self.eval_pdf(ctx, si, wo, active)[0]

        def pdf(
            self, ctx: MitsubaObject, si: MitsubaObject, wo: JitVector, active: JitMask = True
        ) -> JitFloat:
            return self.eval_pdf(ctx, si, wo, active)[1]

        def find_component_kind(self, component: JitInt) -> JitInt:
            """Return Mitsuba's flag of a component, diffuse or glossy, without its other flags."""
            kinds = [int(c) & int(mi.BSDFFlags.Reflection) for c in self.m_components]
            kind = mi.UInt32(kinds[0])
            for k, other in enumerate(kinds[1:], 1):
                kind = dr.select(component == k, other, kind)
            return kind

    return BaseBsdf
