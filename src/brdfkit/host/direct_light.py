"""Direct light of lights that have one place or direction, with shadows however they are found."""

import drjit as dr


def direct_light(si, sampler, lights, active):
    """The light that surfaces send to the camera: Σ ρ(ω_l, ω_o) cosθ_l E_l V.

    si : a `mi.SurfaceInteraction3f`.
    lights : pairs of an emitter and its shadow, whose `lit(p, n, active)` is V, in [0, 1], at
        points of surfaces and by their normals.
    """
    import mitsuba as mi

    seen = active & si.is_valid()
    bsdf, context = si.bsdf(), mi.BSDFContext()
    radiance = mi.UnpolarizedSpectrum(0)
    for emitter, shadow in lights:
        ds, light = emitter.sample_direction(si, sampler.next_2d(seen), seen)
        value = bsdf.eval(context, si, si.to_local(ds.d), seen)
        lit = shadow.lit(si.p, si.n, seen)
        radiance += mi.unpolarized_spectrum(value) * mi.unpolarized_spectrum(light) * lit
    return mi.depolarizer(dr.select(seen, radiance, 0))
