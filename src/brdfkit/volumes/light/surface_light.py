"""Direct light on a surface that is no shape of the scene, by lamps and by its BSDF.

Two directions for each sample, one drawn by the scene's emitters and one by the BSDF, each weighted
by the balance heuristic [Veach & Guibas 1995]. Derivatives go through the weights as well, and the
direction that the BSDF drew stays as it is in the world while the surface turns.
"""

import drjit as dr

from brdfkit.volumes.light.emitters import ray_to


def direct_light(scene, si, bsdf, sampler, shows, active):
    """The radiance that a surface sends to where it is looked at from.

    si, bsdf : the point, a `mi.SurfaceInteraction3f`, and its `mi.BSDF`.
    shows : a function (ray, active) → whether a ray with its `maxt` is free; shapes are in its way
        in any case.
    """
    drawn = sampler.next_2d(active)
    of_lamps = by_emitters(scene, si, bsdf, drawn, shows, active)
    drawn = sampler.next_1d(active), sampler.next_2d(active)
    return of_lamps + by_bsdf(scene, si, bsdf, *drawn, shows, active)


def by_emitters(scene, si, bsdf, sample, shows, active):
    import mitsuba as mi

    active = active & mi.has_flag(bsdf.flags(), mi.BSDFFlags.Smooth)
    ds, light = scene.sample_emitter_direction(si, sample, True, active)
    active = active & (ds.pdf > 0)
    value, pdf = bsdf.eval_pdf(mi.BSDFContext(), si, si.to_local(ds.d), active)
    weight = dr.select(ds.delta, 1, ds.pdf / dr.select(active, ds.pdf + pdf, 1))
    found = mi.unpolarized_spectrum(value) * mi.unpolarized_spectrum(light) * weight
    return dr.select(active & shows(ray_to(si, ds), active), found, 0)


def by_bsdf(scene, si, bsdf, sample1, sample2, shows, active):
    import mitsuba as mi

    context = mi.BSDFContext()
    bs, value = bsdf.sample(context, si, sample1, sample2, active)
    active = active & (bs.pdf > 0)
    mirrored = mi.has_flag(bs.sampled_type, mi.BSDFFlags.Delta)
    wo = dr.detach(si.to_world(bs.wo))
    f, pdf = bsdf.eval_pdf(context, si, si.to_local(wo), active & ~mirrored)
    f = mi.unpolarized_spectrum(f) / dr.detach(dr.select(active, bs.pdf, 1))
    f = dr.select(mirrored, mi.unpolarized_spectrum(value), f)

    # The light in this direction, and its density
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
    return dr.select(active & shows(ray, active), f * light * weight, 0)
