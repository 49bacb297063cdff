"""Silhouettes: how a picture changes where a surface begins to cover what lies behind it.

A cone about a camera ray meets the surface where g(t) = f / L - ρ(t) falls to 0. Where it passes by
closely, g has a minimum g₀ > 0, and as g₀ falls to 0 the light L_b from behind gives way to the
light L_f of the surface. So the derivative of the picture by whatever moves the surface is

    ∫ δ(g₀) ∂g₀ (L_b - L_f) du

over the points u of the picture. δ is taken as 1/ε where 0 < g₀ < ε, so that camera rays that are
traced anyway find it. The ε of `BAND` times ρ is less than a pixel: the silhouette is taken ε/2
outside of where it is, and its derivative is wrong by ε over the surface's radius of curvature.

[Wang et al. 2024]
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr

from brdfkit.core.jit.loops import recorded
from brdfkit.distance_fields.shading.seen_point import FINEST, SeenPoint, cone_of
from brdfkit.distance_fields.tracing.normals import normal
from brdfkit.mitsuba_bridge.surface_points import interaction

BAND = 4.0  # ε over ρ
STEPS = 512  # of a march, as of `cone_trace`
GRAZING = 0.01  # the cosine at which the surface is seen there: 0 is no direction that reflects


@dataclass(frozen=True)
class NearMiss:
    """Where a camera ray passes a silhouette closely.

    seen : the `SeenPoint` there, which the ray would see if the surface reached it.
    gap : Float, g₀, with its derivatives.
    band : Float, ε.
    """

    seen: Any
    gap: Any
    band: Any

    def covered(self, behind, front):
        """The light from `behind`, with the derivatives of its giving way to that in `front`."""
        weight = dr.detach(dr.select(self.seen.found, (behind - front) / self.band, 0))
        return behind + weight * (self.gap - dr.detach(self.gap))


@recorded
def near_miss(field, ray, far, precision, active):
    """The `NearMiss` of each `mi.RayDifferential3f` before `far`, where it meets the surface."""
    radius, tangent = cone_of(ray)

    def rho(t):
        return radius + 1.25 * precision + t * tangent  # as `seen_point` has it

    def gap(t):
        return field.distance(ray(t)) / field.lipschitz - rho(t)

    with dr.suspend_grad():
        t = nearest_pass(gap, rho, tangent, dr.detach(far), active)
        found = active & (t > 0)
        ball = dr.maximum(field.distance(ray(t)) / field.lipschitz, precision / 2)
        n = normal(field.distance, ray(t), dr.maximum(ball, FINEST * precision))
        n = dr.normalize(n - ray.d * (dr.dot(n, ray.d) + GRAZING))
        seen = SeenPoint(interaction(ray, t, ray(t), n, found), ray(t), ball, found)
    return NearMiss(seen, gap(t), BAND * rho(t))


def nearest_pass(gap, rho, tangent, far, active):
    """The t of the least minimum of the gap that is within the band, 0 where there is none."""

    def goes_on(t, before, here, least, place, i):
        return active & (t < far) & (i < STEPS)

    def step(t, before, here, least, place, i):
        ahead = t + dr.maximum(here, rho(t)) / (1 + abs(tangent))
        there = gap(ahead)
        lowest = (here < before) & (here <= there) & (ahead < far) & (here > 0)
        lowest &= here < dr.minimum(least, BAND * rho(t))
        least, place = dr.select(lowest, here, least), dr.select(lowest, t, place)
        return ahead, here, there, least, place, i + 1

    zero = 0 * far
    first = gap(zero)
    begin = zero, first, first, zero + dr.inf, zero, dr.uint32_array_t(type(zero))(0)
    return dr.while_loop(begin, goes_on, step)[4]
