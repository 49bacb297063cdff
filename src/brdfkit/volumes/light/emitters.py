"""The light of a scene's emitters: what a ray meets of it, and what a sample of it sends.

Both may find the same light, and are weighted by the power heuristic [Veach & Guibas 1995].
"""

import drjit as dr


def seen(scene, ray, si, density, active=True):
    """The light that rays see where they meet a surface, or nothing, weighted.

    density : with which the rays were drawn [sr⁻¹]; 0 where no sample of an emitter is like them.
    """
    import mitsuba as mi

    light = mi.unpolarized_spectrum(si.emitter(scene).eval(si, active))
    with dr.suspend_grad():
        rival = active & (density > 0)
        origin = dr.zeros(mi.Interaction3f)
        origin.p, origin.time, origin.wavelengths = ray.o, ray.time, ray.wavelengths
        ds = mi.DirectionSample3f(scene, si, origin)
        pdf = scene.pdf_emitter_direction(origin, ds, rival)
        weight = dr.select(rival, power_heuristic(density, pdf), 1)
    return dr.select(active, light * weight, 0)


def sampled(scene, it, sample, active):
    """A sample of the emitters as `it` sees them, by an even `sample` of two numbers: the
    `mi.DirectionSample3f`, its light over its density, were nothing between, and whether there is
    one.

    The light has the derivatives by what the emitter emits.
    """
    import mitsuba as mi

    with dr.suspend_grad():
        ds, light = scene.sample_emitter_direction(it, sample, False, active)
        there = active & (ds.pdf > 0)
        ds.pdf = dr.select(there, ds.pdf, 1)
    attached = mi.unpolarized_spectrum(scene.eval_emitter_direction(it, ds, there)) / ds.pdf
    light = dr.replace_grad(mi.unpolarized_spectrum(light), attached)
    return ds, dr.select(there, light, 0), there


def ray_to(it, ds):
    """The ray from `it` to a sample of an emitter; to the sky it has no end.

    Mitsuba's distance of the sky is that of a sphere about the shapes, which volumes may leave.
    """
    import mitsuba as mi

    infinite = mi.has_flag(ds.emitter.flags(), mi.EmitterFlags.Infinite)
    ray = it.spawn_ray(ds.d)
    ray.maxt = dr.select(infinite, dr.inf, ds.dist * (1 - mi.math.ShadowEpsilon))
    return ray


def are_met(scene, si):
    """Whether rays that end at `si` end at an emitter."""
    return si.emitter(scene).flags() != 0  # a missing one has none


def power_heuristic(density, other):
    """The weight of what was drawn with a `density` > 0, and might have been with the `other`."""
    return 1 / (1 + dr.square(other / density))
