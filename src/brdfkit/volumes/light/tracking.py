"""Where light collides in a volume, and how much passes through: unbiased, by random look-ups.

A volume with the extinction σ is filled up to its majorant with particles that let light pass.
Collisions with all particles are drawn one after the other. Each is real with the probability
σ / majorant (Woodcock tracking), or light loses that share at each of them (ratio tracking, with
less variance for the same look-ups). What light loses there has collided there, so that one ray
finds both the share that passes and a collision of the remainder. [Woodcock et al. 1965]; [Novák et
al. 2014]

The functions here take

- `extinction(p, active)`: σ [1/unit of length] at a `mitsuba.Point3f`; 0 outside the box;
- `majorants`: its upper bounds, whose box is the volume's;
- `ray`, `t_min`, `t_max`: rays, whose directions need not have unit length, and the part of them in
  which light may collide; distances are in units of the direction's length;
- `sampler`: a `mitsuba.Sampler`, for one or two random numbers per look-up;
- `active`: which rays are followed; all light of the others passes.

A result is NaN where σ exceeds its majorant, and the last result is always the number of look-ups.
Rays walk through the cells of the `Majorants` [Amanatides & Woo 1987] with one optical depth after
another; empty cells cost no look-up. There are no derivatives, and no scalar variants.
"""

from collections.abc import Callable
from typing import Any, TypeAlias

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitInt, JitMask, JitVector, MitsubaObject
from brdfkit.volumes.light.majorants import ROUNDING, Majorants

Extinction: TypeAlias = Callable[[JitVector, JitMask], JitFloat]

SMALLEST_COMPONENT = 1e-20  # of a direction: none is 0, since the walk divides by it
FAINT = 0.15  # share of light below which rays end at random; the others continue as strong as this


def sample_collision(
    extinction: Extinction,
    majorants: Majorants,
    ray: MitsubaObject,
    t_min: JitFloat,
    t_max: JitFloat,
    sampler: MitsubaObject,
    active: JitMask = True,
) -> tuple[JitFloat, JitInt]:
    """Return the distance of a first collision, of density σ(t) T(t); infinity if light passes.

    T(t) is the transmittance up to t.

    >>> t, lookups = sample_collision(smoke, Majorants.from_grid(values), ray, 0, si.t, sampler)
    """
    import mitsuba as mi

    def meet(
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
    through, results, lookups = _follow(meet, results, 0, extinction, majorants, rays, sampler)
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
    """Return a random share of light, 0 to 1, whose mean is the transmittance T.

    >>> share, _ = estimate_transmittance(smoke, majorants, si.spawn_ray(d), 0, dr.inf, sampler)
    """

    def meet(
        share: JitFloat, t: JitFloat, through: JitFloat, results: list[JitFloat], *_: Any
    ) -> tuple[JitFloat, list[JitFloat]]:
        return through * dr.maximum(1 - share, 0), results

    rays, smallest = (ray, t_min, t_max, active), FAINT * sampler.next_1d(active)
    through, _, lookups = _follow(meet, [], smallest, extinction, majorants, rays, sampler)
    return _strengthen_faint(through, smallest), lookups


def split_light(
    extinction: Extinction,
    majorants: Majorants,
    ray: MitsubaObject,
    t_min: JitFloat,
    t_max: JitFloat,
    sampler: MitsubaObject,
    active: JitMask = True,
) -> tuple[JitFloat, JitFloat, JitFloat, JitInt]:
    """Return the share of light that passes, the share that collides, and a collision's distance.

    The shares have the means T and 1 - T, and sum to 1 except for faint rays. The mean of the
    second times any f(distance) is ∫ σ(t) T(t) f(t) dt. `sample_collision` has the same mean, but a
    ray either collides or passes there, and does both here. The distance is infinite where nothing
    collides.

    >>> share, collided, t, _ = split_light(smoke, majorants, ray, 0, si.t, sampler)
    >>> radiance = share * behind + collided * scattered_at(ray(t))
    """
    import mitsuba as mi

    def meet(
        share: JitFloat,
        t: JitFloat,
        through: JitFloat,
        results: list[JitFloat],
        sampler: MitsubaObject,
        tested: JitMask,
    ) -> tuple[JitFloat, list[JitFloat]]:
        # Each collision is chosen with the probability of its part of them all
        collided, distance = results
        here = dr.select(tested, dr.maximum(through, FAINT) * dr.minimum(share, 1), 0)
        collided = collided + here
        # The first one is always chosen, even by a random number that is rounded up to 1
        first = dr.isinf(distance)
        chosen = (here > 0) & (first | (sampler.next_1d(tested) * collided < here))
        return through * dr.maximum(1 - share, 0), [collided, dr.select(chosen, t, distance)]

    rays, results = (ray, t_min, t_max, active), [mi.Float(0), mi.Float(dr.inf)]
    smallest = FAINT * sampler.next_1d(active)
    through, results, lookups = _follow(
        meet, results, smallest, extinction, majorants, rays, sampler
    )
    collided, distance = results
    return _strengthen_faint(through, smallest), collided, distance, lookups


def _strengthen_faint(through: JitFloat, smallest: JitFloat) -> JitFloat:
    """Return the share of light that passes, unbiased although rays end at the share `smallest`.

    `smallest` is FAINT times a uniform random number: of rays with a share below FAINT, the part
    share / FAINT continues, with the share FAINT.
    """
    return dr.select(through <= smallest, 0, dr.select(through < FAINT, FAINT, through))


def _follow(
    meet: Callable[..., tuple[JitFloat, list[JitFloat]]],
    results: list[JitFloat],
    smallest: JitFloat,
    extinction: Extinction,
    majorants: Majorants,
    rays: tuple[MitsubaObject, JitFloat, JitFloat, JitMask],
    sampler: MitsubaObject,
) -> tuple[JitFloat, list[JitFloat], JitInt]:
    """Follow rays until no more than the share `smallest` passes.

    `meet(share, t, through, results, sampler, tested)` returns what passes a particle at t that is
    real with the probability `share`, and the updated list of `results`. Returns the share that
    passes, the results, and the number of look-ups.
    """
    import mitsuba as mi

    ray, t_min, t_max, active = rays

    # The ray in coordinates in which cells are unit cubes, and the part of it in the box
    transform = mi.Transform4f(majorants.world_to_cells.tolist())
    o: Any = transform @ mi.Point3f(ray.o)
    d: Any = transform @ mi.Vector3f(ray.d)
    d = dr.select(dr.abs(d) < SMALLEST_COMPONENT, SMALLEST_COMPONENT, d)
    end = mi.Point3f(*majorants.shape)
    a, b = -o / d, (end - o) / d
    t = dr.maximum(dr.max(dr.minimum(a, b)), t_min)
    t_max = dr.minimum(dr.min(dr.maximum(a, b)), t_max)

    # The first cell, and where the ray leaves it along each axis
    last = mi.Vector3i(*(n - 1 for n in majorants.shape))
    cell = dr.clip(mi.Vector3i(dr.floor(o + d * t)), 0, last)
    leave = (mi.Vector3f(cell) + dr.select(d > 0, 1, 0) - o) / d
    towards, apart = mi.Vector3i(dr.sign(d)), dr.abs(1 / d)

    def goes_on(t: JitFloat, depth: JitFloat, through: JitFloat, *_: Any) -> JitMask:
        return active & (t < t_max) & (through > smallest)

    def step(
        t: JitFloat,
        depth: JitFloat,
        through: JitFloat,
        cell: JitVector,
        leave: JitVector,
        results: list[JitFloat],
        lookups: JitInt,
        sampler: MitsubaObject,
    ) -> tuple[Any, ...]:
        # To a particle after the optical `depth`, or to the end of the cell
        i = dr.clip(cell, 0, last)
        index = mi.UInt32(i.x + (last.x + 1) * (i.y + (last.y + 1) * i.z))
        majorant = dr.gather(mi.Float, majorants.array, index)
        exit_at = dr.minimum(dr.min(leave), t_max)
        particle = t + dr.select(majorant > 0, depth / majorant, dr.inf)
        tested = particle < exit_at
        depth = dr.select(tested, 0, depth - majorant * (exit_at - t))
        t = dr.select(tested, particle, exit_at)

        # Through the particle; an extinction above the majorant visibly spoils the result
        sigma = extinction(ray.o + ray.d * t, tested)
        passed, results = meet(sigma / majorant, t, through, results, sampler, tested)
        passed = dr.select(sigma <= majorant * (1 + ROUNDING), passed, dr.nan)
        through = dr.select(tested, passed, through)
        depth = dr.select(tested, -dr.log(1 - sampler.next_1d(tested)), dr.maximum(depth, 0))
        lookups = lookups + dr.select(tested, mi.UInt32(1), 0)

        # Into the next cell
        crossed = ~tested & (leave <= exit_at)
        cell = dr.select(crossed, cell + towards, cell)
        leave = dr.select(crossed, leave + apart, leave)
        return t, depth, through, cell, leave, results, lookups, sampler

    with dr.suspend_grad():
        depth = -dr.log(1 - sampler.next_1d(active))
        state = (t, depth, mi.Float(1), cell, leave, results, mi.UInt32(0), sampler)
        _, _, through, _, _, results, lookups, _ = dr.while_loop(state, goes_on, step)
    return through, results, lookups
