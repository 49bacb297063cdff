"""Direct light on a surface that is not a shape of the scene, such as an isosurface.

Each sample has two directions, one drawn by the scene's emitters and one by the BSDF, which are
weighted by the balance heuristic [Veach & Guibas 1995]. For derivatives, the weights are
differentiated as well, and the BSDF's direction counts as constant in world coordinates.
"""

from collections.abc import Callable
from typing import TypeAlias

import drjit as dr

from brdfkit.core.array_types import JitColour, JitFloat, JitMask, JitVector, MitsubaObject
from brdfkit.volumes.light.emitters import spawn_ray_to_emitter

IsUnblocked: TypeAlias = Callable[[MitsubaObject, JitMask], JitMask]


def sample_direct_light(
    scene: MitsubaObject,
    si: MitsubaObject,
    bsdf: MitsubaObject,
    sampler: MitsubaObject,
    is_unblocked: IsUnblocked,
    active: JitMask,
) -> JitColour:
    """Estimate the direct light that a surface reflects towards the viewer, by two shadow rays.

    `si` is the surface's point, a `mi.SurfaceInteraction3f`, with the material `bsdf`.
    `is_unblocked(ray, active)` returns whether the surface itself lets a shadow ray pass up to its
    `maxt`; the scene's shapes are tested here.
    """
    sample = sampler.next_2d(active)
    by_emitters = _sample_emitters(scene, si, bsdf, sample, is_unblocked, active)
    sample1, sample2 = sampler.next_1d(active), sampler.next_2d(active)
    return by_emitters + _sample_bsdf(scene, si, bsdf, sample1, sample2, is_unblocked, active)


def _sample_emitters(
    scene: MitsubaObject,
    si: MitsubaObject,
    bsdf: MitsubaObject,
    sample: JitVector,
    is_unblocked: IsUnblocked,
    active: JitMask,
) -> JitColour:
    """Return the weighted light that is reflected from a direction drawn by the emitters."""
    import mitsuba as mi

    active = active & mi.has_flag(bsdf.flags(), mi.BSDFFlags.Smooth)
    ds, light = scene.sample_emitter_direction(si, sample, True, active)
    active = active & (ds.pdf > 0)
    value, pdf = bsdf.eval_pdf(mi.BSDFContext(), si, si.to_local(ds.d), active)
    weight = dr.select(ds.delta, 1, ds.pdf / dr.select(active, ds.pdf + pdf, 1))
    reflected = mi.unpolarized_spectrum(value) * mi.unpolarized_spectrum(light) * weight
    return dr.select(active & is_unblocked(spawn_ray_to_emitter(si, ds), active), reflected, 0)


def _sample_bsdf(
    scene: MitsubaObject,
    si: MitsubaObject,
    bsdf: MitsubaObject,
    sample1: JitFloat,
    sample2: JitVector,
    is_unblocked: IsUnblocked,
    active: JitMask,
) -> JitColour:
    """Return the weighted light that is reflected from a direction drawn by the BSDF."""
    import mitsuba as mi

    context = mi.BSDFContext()
    bs, value = bsdf.sample(context, si, sample1, sample2, active)
    active = active & (bs.pdf > 0)
    mirrored = mi.has_flag(bs.sampled_type, mi.BSDFFlags.Delta)
    wo = dr.detach(si.to_world(bs.wo))
    f, pdf = bsdf.eval_pdf(context, si, si.to_local(wo), active & ~mirrored)
    f = mi.unpolarized_spectrum(f) / dr.detach(dr.select(active, bs.pdf, 1))
    f = dr.select(mirrored, mi.unpolarized_spectrum(value), f)

    # Radiance from the direction wo, and the density with which the emitters would draw wo
    ray = si.spawn_ray(wo)
    far = scene.ray_intersect(ray, active)
    emitter = far.emitter(scene)
    if emitter is None:
        return mi.UnpolarizedSpectrum(0)
    light = mi.unpolarized_spectrum(emitter.eval(far, active))
    ds = mi.DirectionSample3f(scene, far, si)
    by_lamp = scene.pdf_emitter_direction(si, ds, active & ~mirrored)
    weight = dr.select(mirrored, 1, pdf / dr.select(pdf + by_lamp > 0, pdf + by_lamp, 1))
    ray.maxt = far.t
    return dr.select(active & is_unblocked(ray, active), f * light * weight, 0)
