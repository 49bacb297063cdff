"""Where light collides in a volume, and how much of it comes through: by random look-ups, unbiased.

A volume is filled up to its majorant with particles that let light through. Collisions with all of
them are drawn one after the other, and each is real with the probability σ / majorant: Woodcock
tracking. Or light loses that share at each of them: ratio tracking, of less variance for the same
look-ups. [Woodcock et al. 1965]; [Novák et al. 2014].

Rays walk through the cells of the `Majorants` [Amanatides & Woo 1987] with one optical depth after
another; empty cells cost no look-up. Not in scalar variants, and without derivatives.
"""

from collections.abc import Callable
from typing import Any

import drjit as dr

from brdfkit.volumes.majorants import ROUNDING, Majorants

FLATTEST = 1e-20  # of a direction's components: none is 0, by which the walk divides
FAINT = 0.01  # of what comes through; below, most rays end, and a few go on as strong as this


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

    def meet(share, through, sampler, tested):
        return dr.select(sampler.next_1d(tested) < share, 0, through)

    t, through, lookups = _fly(meet, extinction, majorants, ray, t_min, t_max, sampler, active)
    distance = dr.select(through > 0, dr.inf, t)
    return dr.select(dr.isnan(through), dr.nan, distance), lookups


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
        Gives two random numbers for each look-up.
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

    def meet(share, through, sampler, tested):
        rest = through * dr.maximum(1 - share, 0)
        goes_on = sampler.next_1d(tested) * FAINT < rest
        return dr.select(rest < FAINT, dr.select(goes_on, FAINT, 0), rest)

    _, share, lookups = _fly(meet, extinction, majorants, ray, t_min, t_max, sampler, active)
    return share, lookups


def _fly(meet, extinction, majorants, ray, t_min, t_max, sampler, active):
    """Follow rays to `t_max`, or until nothing comes `through`; returns t, `through`, look-ups.

    `meet(share, through, sampler, tested)`: what comes through a particle that is real with the
    probability `share`.
    """
    import mitsuba as mi

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

    def flies(t, depth, through, cell, leave, lookups, sampler):
        return active & (t < t_max) & (through > 0)

    def step(t, depth, through, cell, leave, lookups, sampler):
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
        rest = meet(sigma / majorant, through, sampler, tested)
        rest = dr.select(sigma <= majorant * (1 + ROUNDING), rest, dr.nan)
        through = dr.select(tested, rest, through)
        depth = dr.select(tested, -dr.log(1 - sampler.next_1d(tested)), dr.maximum(depth, 0))
        lookups = lookups + dr.select(tested, mi.UInt32(1), 0)

        # Into the next cell
        crossed = ~tested & (leave <= exit_at)
        cell = dr.select(crossed, cell + towards, cell)
        leave = dr.select(crossed, leave + apart, leave)
        return t, depth, through, cell, leave, lookups, sampler

    with dr.suspend_grad():
        depth = -dr.log(1 - sampler.next_1d(active))
        state = (t, depth, mi.Float(1), cell, leave, mi.UInt32(0), sampler)
        t, _, through, _, _, lookups, _ = dr.while_loop(state, flies, step)
    return t, through, lookups
