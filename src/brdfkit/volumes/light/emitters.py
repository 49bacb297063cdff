"""Estimates the light from a scene's emitters: with rays that hit one, and with sampled points.

Both methods find the same light, so the power heuristic weights them [Veach & Guibas 1995].
"""

import drjit as dr

from brdfkit.core.array_types import JitColour, JitFloat, JitMask, JitVector, MitsubaObject
from brdfkit.core.jit.gradients import replace_grad


def evaluate_emitter_hit(
    scene: MitsubaObject,
    ray: MitsubaObject,
    si: MitsubaObject,
    density: JitFloat,
    active: JitMask = True,
) -> JitColour:
    """Return the radiance of the emitters that rays hit at `si`, weighted by the power heuristic.

    `density` [sr⁻¹] is the density with which the rays' directions were drawn. It is 0 where
    `sample_emitters` cannot find the same light, which then has the weight 1.
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


def sample_emitters(
    scene: MitsubaObject, it: MitsubaObject, sample: JitVector, active: JitMask
) -> tuple[MitsubaObject, JitColour, JitMask]:
    """Sample a point of an emitter for each point `it`; `sample` are two uniform random numbers.

    Returns the `mi.DirectionSample3f`; the radiance divided by the density of the sample, without
    any occlusion; and a mask of the points that have a sample. Derivatives with respect to the
    emission pass through the radiance.
    """
    import mitsuba as mi

    with dr.suspend_grad():
        ds, light = scene.sample_emitter_direction(it, sample, False, active)
        there = active & (ds.pdf > 0)
        ds.pdf = dr.select(there, ds.pdf, 1)
    attached = mi.unpolarized_spectrum(scene.eval_emitter_direction(it, ds, there)) / ds.pdf
    light = replace_grad(mi.unpolarized_spectrum(light), attached)
    return ds, dr.select(there, light, 0), there


def spawn_ray_to_emitter(it: MitsubaObject, ds: MitsubaObject) -> MitsubaObject:
    """Return the shadow ray from `it` to the sample `ds` of an emitter.

    A ray to an environment map is infinite: Mitsuba puts these emitters on a sphere around the
    shapes, but volumes may reach beyond it.
    """
    import mitsuba as mi

    infinite = mi.has_flag(ds.emitter.flags(), mi.EmitterFlags.Infinite)
    ray = it.spawn_ray(ds.d)
    ray.maxt = dr.select(infinite, dr.inf, ds.dist * (1 - mi.math.ShadowEpsilon))
    return ray


def is_emitter_hit(scene: MitsubaObject, si: MitsubaObject) -> JitMask:
    """Return a mask of the rays that end at an emitter, given their intersections `si`."""
    return si.emitter(scene).flags() != 0  # a missing emitter has no flags


def power_heuristic(density: JitFloat, other: JitFloat) -> JitFloat:
    """Return the power heuristic's weight of samples that another method may draw as well.

    Both densities are per solid angle: `density` > 0 of the method that drew the sample, and
    `other` of the other method.
    """
    return 1 / (1 + dr.square(other / density))
