"""`monte_carlo`: hard rays through points of the disc, the truth that all others are held to.

The points are Halton's: u, φ in bases 2 and 3, at √u from the centre. A ray leads from the section
at the surface point to that at the light, through the apex of the cone.

[Bálint et al. 2019, section 3.3]
"""

import drjit as dr
import numpy as np

from brdfkit.core.jit.padding import pad
from brdfkit.distance_fields.shadows.field import distance_of, lipschitz_of
from brdfkit.distance_fields.shadows.shadow import Shadow

MOST = 512  # steps of a ray


def monte_carlo(field, cone, rays=64, hit=1e-3):
    """The `Shadow`: the share of `rays` that reach the light; `r` and `t` are those of no place.

    A ray meets an object where the distance is less than `hit`, over the radius of the cone.
    """
    cone = cone.detached()
    Float = type(cone.d)
    UInt = dr.uint32_array_t(Float)
    xs, ys = (Float(pad(q)) for q in halton_disc(rays))
    zero = 0 * cone.d

    def one_ray(k, lit, evaluations):
        x, y = dr.gather(Float, xs, k), dr.gather(Float, ys, k)
        room, n = trace(field, cone, x, y, hit)
        through = dr.select(room > 0, 1, dr.select(room <= 0, 0, dr.nan))
        return k + 1, lit + through, evaluations + n

    with dr.suspend_grad():
        first = dr.zeros(UInt, dr.width(zero))
        _, lit, evaluations = dr.while_loop(
            (first, zero, zero), lambda k, lit, evaluations: k < rays, one_ray
        )
    return Shadow(lit / rays, zero + dr.nan, zero + dr.nan, evaluations)


def trace(field, cone, x, y, hit):
    """The room that the ray at (x, y) of the disc has left, 0 or less where it met an object, and
    its evaluations."""
    f, tan = distance_of(field), cone.tan
    speed = lipschitz_of(field) * dr.sqrt(1 + tan * tan * (x * x + y * y))
    zero = 0 * cone.d

    def going_on(t, room, i):
        return (t < cone.d) & (room > 0) & (i < MOST)

    def one_step(t, room, i):
        F = f(cone.across(t, x, y))
        return t + dr.maximum(F, 0) / speed, F - hit * cone.radius(t), i + 1

    _, room, n = dr.while_loop((zero, zero + 1, zero), going_on, one_step)
    return room, n


def halton_disc(n):
    """x and y of Halton's first n points, uniform over the unit disc."""
    from scipy.stats.qmc import Halton

    u, phi = Halton(2, scramble=False).random(n + 1)[1:].T  # the first is the corner (0, 0)
    return np.sqrt(u) * np.cos(2 * np.pi * phi), np.sqrt(u) * np.sin(2 * np.pi * phi)
