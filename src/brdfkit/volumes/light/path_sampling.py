"""Random choices of a path tracer in volumes: samples of the emitters, and Russian roulette."""

import drjit as dr

from brdfkit.core.array_types import JitColour, JitFloat, JitInt, JitMask, JitVector, MitsubaObject
from brdfkit.volumes.light import emitters
from brdfkit.volumes.light.medium import Medium
from brdfkit.volumes.light.vertex import Vertex

ROULETTE_DEPTH = 5  # number of scatterings after which dark paths end at random
# The least probability with which a path survives, and with which either of two samples is chosen
SMALLEST_CHANCE = 0.05


def scatter_direct_light(
    scene: MitsubaObject, medium: Medium, vertex: Vertex, sampler: MitsubaObject
) -> JitColour:
    """Return the light of the emitters that reaches a vertex and is scattered into the path.

    The `medium` weakens the light on its way. With several emitters, two of them are sampled, one
    from each half of the list, and the shadow ray to one of these samples is followed.
    """
    import mitsuba as mi

    u = sampler.next_2d(vertex.active)
    if len(scene.emitters()) > 1:
        halves = [mi.Point2f((u.x + k) / 2, u.y) for k in range(2)]
        first, second = (sample_unshadowed_light(scene, vertex, half) for half in halves)
        ray, light, lit = choose_sample_by_brightness(first, second, sampler.next_1d(vertex.active))
    else:
        ray, light, lit = sample_unshadowed_light(scene, vertex, u)
    with dr.suspend_grad():
        lit = lit & ~scene.ray_test(ray, lit)
    share = medium.estimate_transmittance(ray, ray.maxt, sampler, lit)
    return dr.select(lit, light * share, 0)


def sample_unshadowed_light(
    scene: MitsubaObject, vertex: Vertex, u: JitVector
) -> tuple[MitsubaObject, JitColour, JitMask]:
    """Sample the emitters, and return a shadow ray, the scattered light and a mask.

    The light is the one that arrives if nothing blocks the ray; the mask is False where the
    emitters have no sample.
    """
    it = vertex.interaction
    ds, light, there = emitters.sample_emitters(scene, it, u, vertex.active)
    value, pdf = vertex.eval_pdf(ds.d)
    weight = dr.select(ds.delta, 1, emitters.power_heuristic(ds.pdf, dr.detach(pdf)))
    return emitters.spawn_ray_to_emitter(it, ds), value * light * weight, there


def choose_sample_by_brightness(
    first: tuple[MitsubaObject, JitColour, JitMask],
    second: tuple[MitsubaObject, JitColour, JitMask],
    u: JitFloat,
) -> tuple[MitsubaObject, JitColour, JitMask]:
    """Choose one of two samples (ray, light, mask) at random, mostly the brighter one.

    The light is divided by the probability of the choice, which keeps the mean of both samples
    unbiased. `u` is a uniform random number.
    """
    brightness = [dr.detach(dr.max(light)) for _, light, _ in (first, second)]
    both = brightness[0] + brightness[1]
    chance = dr.select(both > 0, brightness[0] / both, 0.5)
    chance = dr.clip(chance, SMALLEST_CHANCE, 1 - SMALLEST_CHANCE)
    is_first = u < chance
    ray, light, mask = (dr.select(is_first, a, b) for a, b in zip(first, second, strict=True))
    return ray, light / (2 * dr.select(is_first, chance, 1 - chance)), mask


def apply_roulette(depth: JitInt, throughput: JitColour, sampler: MitsubaObject) -> JitColour:
    """Return the throughput of paths after Russian roulette, which ends dark paths at random.

    Paths whose throughput is still 1 always continue. If they could end, too, pictures of white
    clouds, where paths are long, would depend on a few very bright samples.
    """
    chance = dr.clip(dr.max(dr.detach(throughput)), SMALLEST_CHANCE, 1)
    chance = dr.select(depth < ROULETTE_DEPTH, 1, chance)
    return dr.select(sampler.next_1d() < chance, throughput / chance, 0)
