"""Tracking in volumes: unbiased random estimates of collisions and of the transmittance.

A volume with the extinction σ is filled up to its majorant with fictitious particles that let light
pass. Collisions with real and fictitious particles are drawn one after the other along a ray. In
Woodcock tracking each collision is real with the probability σ / majorant [Woodcock et al. 1965].
In ratio tracking light loses that share at each particle, with less variance for the same look-ups
of σ [Novák et al. 2014]. The lost share has collided at the particle, so that one ray yields both
the share of light that passes and a collision of the rest.

All functions take

- `extinction(p, active)`: σ [1/unit of length] at a `mitsuba.Point3f`; 0 outside the box;
- `majorants`: upper bounds of σ in the volume's box;
- `ray`, `t_min`, `t_max`: rays, and the nearest and farthest distance where light may collide. The
  unit is the length of the ray's direction, which need not be 1;
- `sampler`: a `mitsuba.Sampler`, for one or two random numbers per look-up;
- `active`: a mask of the rays that are followed; all light of the other rays passes.

A result is NaN where σ exceeds its majorant, and the last result is the number of look-ups. Rays
walk through the cells of the `Majorants` [Amanatides & Woo 1987]; empty cells cost no look-up. The
functions have no derivatives, and do not support scalar variants.
"""

from collections.abc import Callable
from typing import Any, TypeAlias

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitInt, JitMask, JitVector, MitsubaObject
from brdfkit.volumes.light.majorants import ROUNDING, Majorants

Extinction: TypeAlias = Callable[[JitVector, JitMask], JitFloat]

SMALLEST_COMPONENT = 1e-20  # replaces a direction's component of 0, by which the walk would divide
FAINT = 0.15  # Russian roulette may end a ray that has kept less than this share of its light


def sample_collision(
    extinction: Extinction,
    majorants: Majorants,
    ray: MitsubaObject,
    t_min: JitFloat,
    t_max: JitFloat,
    sampler: MitsubaObject,
    active: JitMask = True,
) -> tuple[JitFloat, JitInt]:
    """Draw the distance t of the first collision; it is infinite if light passes the volume.

    The density of t is σ(t) T(t), where T(t) is the transmittance up to t.

    >>> t, lookups = sample_collision(smoke, Majorants.from_grid(values), ray, 0, si.t, sampler)
    """
    import mitsuba as mi

    def meet_particle(
        share: JitFloat,
        t: JitFloat,
        through: JitFloat,
        results: list[JitFloat],
        sampler: MitsubaObject,
        tested: JitMask,
    ) -> tuple[JitFloat, list[JitFloat]]:
        real = sampler.next_1d(tested) < share
        return dr.select(real, 0, through), [dr.select(real & tested, t, results[0])]

    rays, results = (ray, t_min, t_max, active), [mi.Float(dr.inf)]
    through, results, lookups = _follow_rays(
        meet_particle, results, 0, extinction, majorants, rays, sampler
    )
    return dr.select(dr.isnan(through), dr.nan, results[0]), lookups


def estimate_transmittance(
    extinction: Extinction,
    majorants: Majorants,
    ray: MitsubaObject,
    t_min: JitFloat,
    t_max: JitFloat,
    sampler: MitsubaObject,
    active: JitMask = True,
) -> tuple[JitFloat, JitInt]:
    """Return an unbiased random estimate of the transmittance, 0 to 1, by ratio tracking.

    >>> share, _ = estimate_transmittance(smoke, majorants, si.spawn_ray(d), 0, dr.inf, sampler)
    """

    def meet_particle(
        share: JitFloat, t: JitFloat, through: JitFloat, results: list[JitFloat], *_: Any
    ) -> tuple[JitFloat, list[JitFloat]]:
        return through * dr.maximum(1 - share, 0), results

    rays, smallest = (ray, t_min, t_max, active), FAINT * sampler.next_1d(active)
    through, _, lookups = _follow_rays(
        meet_particle, [], smallest, extinction, majorants, rays, sampler
    )
    return _apply_russian_roulette(through, smallest), lookups


def estimate_passed_and_collided_light(
    extinction: Extinction,
    majorants: Majorants,
    ray: MitsubaObject,
    t_min: JitFloat,
    t_max: JitFloat,
    sampler: MitsubaObject,
    active: JitMask = True,
) -> tuple[JitFloat, JitFloat, JitFloat, JitInt]:
    """Return the share of light that passes, the share that collides, and a collision's distance.

    The shares have the means T and 1 - T, for the transmittance T, and sum to 1 except after
    Russian roulette. The mean of the second share times any f(distance) is ∫ σ(t) T(t) f(t) dt. The
    distance is infinite where nothing collides. In `sample_collision` a ray either collides or
    passes, while here each ray does both, which has less variance.

    >>> settings = smoke, majorants, ray, 0, si.t, sampler
    >>> share, collided, t, _ = estimate_passed_and_collided_light(*settings)
    >>> radiance = share * behind + collided * scattered_at(ray(t))
    """
    import mitsuba as mi

    def meet_particle(
        share: JitFloat,
        t: JitFloat,
        through: JitFloat,
        results: list[JitFloat],
        sampler: MitsubaObject,
        tested: JitMask,
    ) -> tuple[JitFloat, list[JitFloat]]:
        # Reservoir sampling: each collision is chosen in proportion to its share of light
        collided, distance = results
        here = dr.select(tested, dr.maximum(through, FAINT) * dr.minimum(share, 1), 0)
        collided = collided + here
        # The first collision is always chosen, even if the random number is rounded up to 1
        first = dr.isinf(distance)
        chosen = (here > 0) & (first | (sampler.next_1d(tested) * collided < here))
        return through * dr.maximum(1 - share, 0), [collided, dr.select(chosen, t, distance)]

    rays, results = (ray, t_min, t_max, active), [mi.Float(0), mi.Float(dr.inf)]
    smallest = FAINT * sampler.next_1d(active)
    through, results, lookups = _follow_rays(
        meet_particle, results, smallest, extinction, majorants, rays, sampler
    )
    collided, distance = results
    return _apply_russian_roulette(through, smallest), collided, distance, lookups


def _apply_russian_roulette(through: JitFloat, smallest: JitFloat) -> JitFloat:
    """Return the passing share of light, unbiased although rays end at the share `smallest`.

    `smallest` is FAINT times a uniform random number. A ray whose share is below FAINT thus
    survives with the probability share / FAINT, and then counts with the share FAINT.
    """
    return dr.select(through <= smallest, 0, dr.select(through < FAINT, FAINT, through))


def _follow_rays(
    meet_particle: Callable[..., tuple[JitFloat, list[JitFloat]]],
    results: list[JitFloat],
    smallest: JitFloat,
    extinction: Extinction,
    majorants: Majorants,
    rays: tuple[MitsubaObject, JitFloat, JitFloat, JitMask],
    sampler: MitsubaObject,
) -> tuple[JitFloat, list[JitFloat], JitInt]:
    """Follow rays from particle to particle, until only the share `smallest` of light is left.

    `meet_particle(share, t, through, results, sampler, tested)` is called at each particle, at the
    distance t, which is real with the probability `share`. It returns the light that passes, of the
    light `through` that arrives, and the updated list of `results`. Returns the light that passes
    all particles, the results, and the number of look-ups.
    """
    import mitsuba as mi

    ray, t_min, t_max, active = rays

    # Clip the ray to the box, in coordinates in which cells are unit cubes
    transform = mi.Transform4f(majorants.world_to_cells.tolist())
    o: Any = transform @ mi.Point3f(ray.o)
    d: Any = transform @ mi.Vector3f(ray.d)
    d = dr.select(dr.abs(d) < SMALLEST_COMPONENT, SMALLEST_COMPONENT, d)
    end = mi.Point3f(*majorants.shape)
    a, b = -o / d, (end - o) / d
    t = dr.maximum(dr.max(dr.minimum(a, b)), t_min)
    t_max = dr.minimum(dr.min(dr.maximum(a, b)), t_max)

    # The first cell, and the distances at which the ray leaves it along each axis
    last = mi.Vector3i(*(n - 1 for n in majorants.shape))
    cell = dr.clip(mi.Vector3i(dr.floor(o + d * t)), 0, last)
    leave = (mi.Vector3f(cell) + dr.select(d > 0, 1, 0) - o) / d
    towards, apart = mi.Vector3i(dr.sign(d)), dr.abs(1 / d)

    def is_followed(t: JitFloat, depth: JitFloat, through: JitFloat, *_: Any) -> JitMask:
        return active & (t < t_max) & (through > smallest)

    def step_to_particle(
        t: JitFloat,
        depth: JitFloat,
        through: JitFloat,
        cell: JitVector,
        leave: JitVector,
        results: list[JitFloat],
        lookups: JitInt,
        sampler: MitsubaObject,
    ) -> tuple[Any, ...]:
        # Go to the next particle, by the optical `depth` drawn for it, or at most to the cell's end
        i = dr.clip(cell, 0, last)
        index = mi.UInt32(i.x + (last.x + 1) * (i.y + (last.y + 1) * i.z))
        majorant = dr.gather(mi.Float, majorants.array, index)
        exit_at = dr.minimum(dr.min(leave), t_max)
        particle = t + dr.select(majorant > 0, depth / majorant, dr.inf)
        tested = particle < exit_at
        depth = dr.select(tested, 0, depth - majorant * (exit_at - t))
        t = dr.select(tested, particle, exit_at)

        # Pass the particle; NaN makes an extinction above the majorant visible in pictures
        sigma = extinction(ray.o + ray.d * t, tested)
        passed, results = meet_particle(sigma / majorant, t, through, results, sampler, tested)
        passed = dr.select(sigma <= majorant * (1 + ROUNDING), passed, dr.nan)
        through = dr.select(tested, passed, through)
        depth = dr.select(tested, -dr.log(1 - sampler.next_1d(tested)), dr.maximum(depth, 0))
        lookups = lookups + dr.select(tested, mi.UInt32(1), 0)

        # Enter the next cell if no particle was met
        crossed = ~tested & (leave <= exit_at)
        cell = dr.select(crossed, cell + towards, cell)
        leave = dr.select(crossed, leave + apart, leave)
        return t, depth, through, cell, leave, results, lookups, sampler

    with dr.suspend_grad():
        depth = -dr.log(1 - sampler.next_1d(active))
        state = (t, depth, mi.Float(1), cell, leave, results, mi.UInt32(0), sampler)
        _, _, through, _, _, results, lookups, _ = dr.while_loop(
            state, is_followed, step_to_particle
        )
    return through, results, lookups
