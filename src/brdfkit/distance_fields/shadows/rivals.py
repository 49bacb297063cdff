"""`quilez`: the rival of 2010, a hard shadow ray that notes how near it passes.

The ray ends where it meets an object, so that the inner half of the penumbra is black.

[Quílez 2010]
"""

import drjit as dr

from brdfkit.distance_fields.shadows.field import distance_of, lipschitz_of
from brdfkit.distance_fields.shadows.shadow import Shadow

MOST, HIT = 512, 1e-3  # steps, and the distance of a hit over the light's distance


def quilez(field, cone):
    """The `Shadow`: the smallest k f / t, with the hardness k = d / R_1 of this light."""

    def nearness(t, F, F_before):
        return F / t

    return nearest_passing(field, cone, nearness)


def nearest_passing(field, cone, nearness):
    """The `Shadow` of a hard ray; `nearness(t, F, F_before)` is how near it passes, over t."""
    f, lipschitz, cone = distance_of(field), lipschitz_of(field), cone.detached()
    k, hit = cone.d / cone.R_1, HIT * cone.d

    def going_on(t, visible, t_min, F_before, i):
        return (t < cone.d) & (visible > 0) & (i < MOST)

    def one_step(t, visible, t_min, F_before, i):
        F = f(cone.point(t))
        near = dr.select(hit > F, 0, k * nearness(t, F, F_before))
        t_min = dr.select(near < visible, t, t_min)
        return t + F / lipschitz, dr.minimum(visible, near), t_min, F, i + 1

    with dr.suspend_grad():
        zero = 0 * cone.d
        start = dr.maximum(cone.R_0, hit)  # the rays of both begin off the surface
        found = dr.while_loop((start, zero + 1, zero, zero + 1e20, zero), going_on, one_step)
    _, visible, t_min, _, i = found
    return Shadow(visible, visible, t_min, i)


def aaltonen(field, cone):
    """The `Shadow`: the smallest k √(f² - y²) / (t - y), y = f² / (2 f before)."""

    def nearness(t, F, F_before):
        y = F * F / (2 * F_before)
        return dr.safe_sqrt(F * F - y * y) / dr.maximum(t - y, 1e-6 * t)

    return nearest_passing(field, cone, nearness)
