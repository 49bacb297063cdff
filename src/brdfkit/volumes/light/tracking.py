"""Where light collides in a volume, and how much of it comes through: by random look-ups, unbiased.

A volume is filled up to its majorant with particles that let light through. Collisions with all of
them are drawn one after the other, and each is real with the probability σ / majorant: Woodcock
tracking. Or light loses that share at each of them: ratio tracking, of less variance for the same
look-ups. What it loses there has collided there, so one ray finds both the share that comes through
and a collision of the rest. [Woodcock et al. 1965]; [Novák et al. 2014].

Rays walk through the cells of the `Majorants` [Amanatides & Woo 1987] with one optical depth after
another; empty cells cost no look-up. Not in scalar variants, and without derivatives.
"""

from collections.abc import Callable
from typing import Any

import drjit as dr

from brdfkit.volumes.light.majorants import ROUNDING, Majorants

FLATTEST = 1e-20  # of a direction's components: none is 0, by which the walk divides
FAINT = 0.15  # of what comes through; below, some rays end, and others go on as strong as this


def collide(
    extinction: Callable[[Any, Any], Any],
    majorants: Majorants,
    ray: Any,
    t_min: Any,
    t_max: Any,
    sampler: Any,
    active: Any = True,
) -> tuple[Any, Any]:
    """Where light that follows rays first collides: a distance of density σ(t) T(t).

    Parameters
    ----------
    extinction : callable
        σ(p, active) [1/unit of length] of a `mitsuba.Point3f`; outside the majorants' box it is 0.
    majorants : Majorants
        Its upper bounds.
    ray : mitsuba.Ray3f
        The rays; their directions need not have unit length, distances are in units of it.
    t_min, t_max : number or mitsuba.Float
        Where on the rays it may collide.
    sampler : mitsuba.Sampler
        Gives two random numbers for each look-up.
    active : bool or mitsuba.Bool, default True
        Which rays are followed.

    Returns
    -------
    distance : mitsuba.Float
        Along the ray; infinity where light comes through, NaN where σ was above its majorant.
    lookups : mitsuba.UInt32
        How often σ was asked for.

    Examples
    --------
    >>> t, lookups = collide(smoke, Majorants.of_grid(values), ray, 0, si.t, sampler)
    """
    import mitsuba as mi

    def meet(share, t, through, found, sampler, tested):
        real = sampler.next_1d(tested) < share
        return dr.select(real, 0, through), [dr.select(real & tested, t, found[0])]

    rays, found = (ray, t_min, t_max, active), [mi.Float(dr.inf)]
    through, found, lookups = _fly(meet, found, 0, extinction, majorants, rays, sampler)
    return dr.select(dr.isnan(through), dr.nan, found[0]), lookups


def transmittance(
    extinction: Callable[[Any, Any], Any],
    majorants: Majorants,
    ray: Any,
    t_min: Any,
    t_max: Any,
    sampler: Any,
    active: Any = True,
) -> tuple[Any, Any]:
    """The share of light that comes through along rays: a random number of the mean T.

    Parameters
    ----------
    extinction : callable
        σ(p, active) [1/unit of length] of a `mitsuba.Point3f`; outside the majorants' box it is 0.
    majorants : Majorants
        Its upper bounds.
    ray : mitsuba.Ray3f
        The rays; their directions need not have unit length, distances are in units of it.
    t_min, t_max : number or mitsuba.Float
        Between which points of the rays.
    sampler : mitsuba.Sampler
        Gives a random number for each look-up, and two for the ray.
    active : bool or mitsuba.Bool, default True
        Which rays are followed; of others it is 1.

    Returns
    -------
    share : mitsuba.Float
        0 to 1; NaN where σ was above its majorant.
    lookups : mitsuba.UInt32
        How often σ was asked for.

    Examples
    --------
    >>> share, lookups = transmittance(smoke, majorants, si.spawn_ray(d), 0, dr.inf, sampler)
    """

    def meet(share, t, through, found, sampler, tested):
        return through * dr.maximum(1 - share, 0), found

    rays, least = (ray, t_min, t_max, active), FAINT * sampler.next_1d(active)
    through, _, lookups = _fly(meet, [], least, extinction, majorants, rays, sampler)
    return _not_faint(through, least), lookups


def divide(
    extinction: Callable[[Any, Any], Any],
    majorants: Majorants,
    ray: Any,
    t_min: Any,
    t_max: Any,
    sampler: Any,
    active: Any = True,
) -> tuple[Any, Any, Any, Any]:
    """Light that follows rays as two shares: one comes through, the other collides at a distance.

    The mean of what collides there, times any f(distance), is ∫ σ(t) T(t) f(t) dt. Collisions by
    chance have the same mean; but of these a ray has one or comes through, and here it has both.

    Parameters
    ----------
    extinction : callable
        σ(p, active) [1/unit of length] of a `mitsuba.Point3f`; outside the majorants' box it is 0.
    majorants : Majorants
        Its upper bounds.
    ray : mitsuba.Ray3f
        The rays; their directions need not have unit length, distances are in units of it.
    t_min, t_max : number or mitsuba.Float
        Where on the rays it may collide.
    sampler : mitsuba.Sampler
        Gives two random numbers for each look-up.
    active : bool or mitsuba.Bool, default True
        Which rays are followed; of others all comes through.

    Returns
    -------
    share : mitsuba.Float
        What comes through, 0 to 1, of the mean T; NaN where σ was above its majorant.
    collided : mitsuba.Float
        What collides, of the mean 1 - T, at least 0. Both sum to 1, but for rays that were faint.
    distance : mitsuba.Float
        Along the ray, of one of its collisions; infinity where nothing collides.
    lookups : mitsuba.UInt32
        How often σ was asked for.

    Examples
    --------
    >>> share, collided, t, _ = divide(smoke, majorants, ray, 0, si.t, sampler)
    >>> radiance = share * behind + collided * scattered_at(ray(t))
    """
    import mitsuba as mi

    def meet(share, t, through, found, sampler, tested):
        # Each of the collisions is the one that is told with the chance of its part of them all
        collided, distance = found
        here = dr.select(tested, dr.maximum(through, FAINT) * dr.minimum(share, 1), 0)
        collided = collided + here
        # The first one always, also by a random number that is rounded up to 1
        first = dr.isinf(distance)
        told = (here > 0) & (first | (sampler.next_1d(tested) * collided < here))
        return through * dr.maximum(1 - share, 0), [collided, dr.select(told, t, distance)]

    rays, found = (ray, t_min, t_max, active), [mi.Float(0), mi.Float(dr.inf)]
    least = FAINT * sampler.next_1d(active)
    through, found, lookups = _fly(meet, found, least, extinction, majorants, rays, sampler)
    return _not_faint(through, least), *found, lookups


def _not_faint(through, least):
    """The share of light that came `through`, if rays ended where it fell to `least`.

    That is FAINT times an even random number: of a share below FAINT the part share / FAINT goes
    on, and is as strong as FAINT.
    """
    return dr.select(through <= least, 0, dr.select(through < FAINT, FAINT, through))


def _fly(meet, found, least, extinction, majorants, rays, sampler):
    """Follow rays until no more than `least` comes `through`; returns that, `found`, look-ups.

    `meet(share, t, through, found, sampler, tested)`: what comes through a particle at t that is
    real with the probability `share`, and a list of what was found, which begins as `found`.
    """
    import mitsuba as mi

    ray, t_min, t_max, active = rays

    # The ray where cells are unit cubes, and the part of it in the box
    transform = mi.Transform4f(majorants.world_to_cells.tolist())
    o, d = transform @ mi.Point3f(ray.o), transform @ mi.Vector3f(ray.d)
    d = dr.select(dr.abs(d) < FLATTEST, FLATTEST, d)
    end = mi.Point3f(*majorants.shape)
    a, b = -o / d, (end - o) / d
    t = dr.maximum(dr.max(dr.minimum(a, b)), t_min)
    t_max = dr.minimum(dr.min(dr.maximum(a, b)), t_max)

    # The cell in which it begins, and where it leaves that along each axis
    last = mi.Vector3i(*(n - 1 for n in majorants.shape))
    cell = dr.clip(mi.Vector3i(dr.floor(o + d * t)), 0, last)
    leave = (mi.Vector3f(cell) + dr.select(d > 0, 1, 0) - o) / d
    towards, apart = mi.Vector3i(dr.sign(d)), dr.abs(1 / d)

    def flies(t, depth, through, cell, leave, found, lookups, sampler):
        return active & (t < t_max) & (through > least)

    def step(t, depth, through, cell, leave, found, lookups, sampler):
        # To a particle after the optical `depth`, or to the end of the cell
        i = dr.clip(cell, 0, last)
        index = mi.UInt32(i.x + (last.x + 1) * (i.y + (last.y + 1) * i.z))
        majorant = dr.gather(mi.Float, majorants.array, index)
        exit_at = dr.minimum(dr.min(leave), t_max)
        particle = t + dr.select(majorant > 0, depth / majorant, dr.inf)
        tested = particle < exit_at
        depth = dr.select(tested, 0, depth - majorant * (exit_at - t))
        t = dr.select(tested, particle, exit_at)

        # Through the particle; an extinction above the majorant spoils the result, visibly
        sigma = extinction(ray.o + ray.d * t, tested)
        rest, found = meet(sigma / majorant, t, through, found, sampler, tested)
        rest = dr.select(sigma <= majorant * (1 + ROUNDING), rest, dr.nan)
        through = dr.select(tested, rest, through)
        depth = dr.select(tested, -dr.log(1 - sampler.next_1d(tested)), dr.maximum(depth, 0))
        lookups = lookups + dr.select(tested, mi.UInt32(1), 0)

        # Into the next cell
        crossed = ~tested & (leave <= exit_at)
        cell = dr.select(crossed, cell + towards, cell)
        leave = dr.select(crossed, leave + apart, leave)
        return t, depth, through, cell, leave, found, lookups, sampler

    with dr.suspend_grad():
        depth = -dr.log(1 - sampler.next_1d(active))
        state = (t, depth, mi.Float(1), cell, leave, found, mi.UInt32(0), sampler)
        _, _, through, _, _, found, lookups, _ = dr.while_loop(state, flies, step)
    return through, found, lookups
