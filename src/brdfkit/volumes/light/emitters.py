"""The light of a scene's emitters, found by rays that hit them or by samples of the emitters.

Both may find the same light, and are weighted by the power heuristic [Veach & Guibas 1995].
"""

from typing import Any

import drjit as dr

from brdfkit.core.array_types import JitColour, JitFloat, JitMask, JitVector, MitsubaObject

replace_grad: Any = dr.replace_grad  # Dr.Jit's stub knows no result of it


def evaluate_hit(
    scene: MitsubaObject,
    ray: MitsubaObject,
    si: MitsubaObject,
    density: JitFloat,
    active: JitMask = True,
) -> JitColour:
    """Return the weighted light that rays receive from the emitter at their end `si`.

    `density` [sr⁻¹] is the density with which the rays were drawn; it is 0 where samples of the
    emitters cannot find their light.
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
    """Sample the emitters as seen from `it`, by two uniform numbers.

    Returns the `mi.DirectionSample3f`, its light over its density as if nothing were in its way,
    and whether there is a sample. The light has the derivatives of the emission.
    """
    import mitsuba as mi

    with dr.suspend_grad():
        ds, light = scene.sample_emitter_direction(it, sample, False, active)
        there = active & (ds.pdf > 0)
        ds.pdf = dr.select(there, ds.pdf, 1)
    attached = mi.unpolarized_spectrum(scene.eval_emitter_direction(it, ds, there)) / ds.pdf
    light = replace_grad(mi.unpolarized_spectrum(light), attached)
    return ds, dr.select(there, light, 0), there


def ray_to(it: MitsubaObject, ds: MitsubaObject) -> MitsubaObject:
    """Return the ray from `it` to a sample of an emitter; one to the sky has no end.

    Mitsuba's sky lies on a sphere about the shapes, beyond which volumes may reach.
    """
    import mitsuba as mi

    infinite = mi.has_flag(ds.emitter.flags(), mi.EmitterFlags.Infinite)
    ray = it.spawn_ray(ds.d)
    ray.maxt = dr.select(infinite, dr.inf, ds.dist * (1 - mi.math.ShadowEpsilon))
    return ray


def is_emitter_hit(scene: MitsubaObject, si: MitsubaObject) -> JitMask:
    """Return whether rays that end at `si` end at an emitter."""
    return si.emitter(scene).flags() != 0  # a missing one has none


def power_heuristic(density: JitFloat, other: JitFloat) -> JitFloat:
    """Weight a sample drawn with `density` > 0 that another method draws with density `other`."""
    return 1 / (1 + dr.square(other / density))
