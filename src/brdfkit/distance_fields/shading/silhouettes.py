"""Derivatives at silhouettes, where a surface begins to cover what lies behind it.

At a silhouette the picture jumps from the light L_b from behind to the light L_f of the surface.
Where the jump moves, the picture has a derivative that is found as follows.

At the distance t along a camera ray, a cone around the ray has the gap g(t) = f / L - ρ(t) to the
surface, with the field f, its bound L and the cone's radius ρ. The ray meets the surface where g
falls to 0. A ray that passes closely has a smallest gap g₀ > 0. With ∂ for the derivative with
respect to a parameter that moves the surface, and Dirac's δ, the derivative of the picture is

    ∫ δ(g₀) ∂g₀ (L_b - L_f) du

over the points u of the picture. δ is replaced by 1/ε where 0 < g₀ < ε, so that the camera rays
that are traced anyway can estimate the integral. ε is `BAND_WIDTH` times ρ, less than a pixel. So
the silhouette is taken ε/2 outside of its true position. The relative error of its derivative is ε
divided by the surface's radius of curvature.

[Wang et al. 2024]
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr

from brdfkit.core.array_types import JitColour, JitFloat, JitInt, JitMask, MitsubaObject
from brdfkit.core.jit.loops import record_loops
from brdfkit.distance_fields.node import Node
from brdfkit.distance_fields.shading.visible_point import (
    NORMAL_STEP,
    VisiblePoint,
    compute_ray_cone,
)
from brdfkit.distance_fields.tracing.hits import normal
from brdfkit.mitsuba_bridge.surface_points import make_interaction

BAND_WIDTH = 4.0  # the width of the band around silhouettes, in radii of the cone
MAX_STEPS = 512  # the most steps along a ray, as in `cone_trace`
# The cosine between ray and normal that is used at silhouettes: at 0 a BSDF would reflect nothing
GRAZING_COSINE = 0.01


@dataclass(frozen=True)
class NearMiss:
    """A place where a camera ray passes closely by a silhouette.

    seen : the `VisiblePoint` that the ray would meet if the surface reached it.
    gap : Float, the least gap between the ray's cone and the surface, with its derivatives.
    band : Float, the gap below which rays count as close.
    """

    seen: Any
    gap: Any
    band: Any

    def attach_silhouette_derivatives(self, behind: JitColour, front: JitColour) -> JitColour:
        """Return the light `behind`, with its derivatives as the surface begins to cover it.

        front : the light that the surface reflects.
        """
        weight = dr.detach(dr.select(self.seen.found, (behind - front) / self.band, 0))
        return behind + weight * (self.gap - dr.detach(self.gap))


@record_loops
def find_near_miss(
    field: Node, ray: MitsubaObject, far: JitFloat, precision: JitFloat, active: JitMask
) -> NearMiss:
    """Return where each `mi.RayDifferential3f` passes closely by a silhouette, before `far`.

    precision : the radius of the thinnest cones, as in `find_visible_point`.
    """
    radius, tangent = compute_ray_cone(ray)

    def compute_cone_radius(t: JitFloat) -> JitFloat:
        # The radius at which the cones of `find_visible_point` stop
        return radius + 1.25 * precision + t * tangent

    def compute_gap(t: JitFloat) -> JitFloat:
        return field.distance(ray(t)) / field.lipschitz - compute_cone_radius(t)

    with dr.suspend_grad():
        t = find_nearest_pass(compute_gap, compute_cone_radius, tangent, dr.detach(far), active)
        found = active & (t > 0)
        ball = dr.maximum(field.distance(ray(t)) / field.lipschitz, precision / 2)
        n = normal(field.distance, ray(t), dr.maximum(ball, NORMAL_STEP * precision))
        n = dr.normalize(n - ray.d * (dr.dot(n, ray.d) + GRAZING_COSINE))
        seen = VisiblePoint(make_interaction(ray, t, ray(t), n, found), ray(t), ball, found, field)
    return NearMiss(seen, compute_gap(t), BAND_WIDTH * compute_cone_radius(t))


def find_nearest_pass(
    gap: Any, cone_radius: Any, tangent: JitFloat, far: JitFloat, active: JitMask
) -> JitFloat:
    """Return the distance t of the smallest minimum of `gap` along each ray, 0 if none is close.

    gap : function from t to the gap between the ray's cone and the surface.
    cone_radius : function from t to the radius of the cone.
    """

    def take_step(
        t: JitFloat, before: JitFloat, here: JitFloat, least: JitFloat, place: JitFloat, i: JitInt
    ) -> tuple[Any, ...]:
        ahead = t + dr.maximum(here, cone_radius(t)) / (1 + abs(tangent))
        there = gap(ahead)
        lowest = (here < before) & (here <= there) & (ahead < far) & (here > 0)
        lowest &= here < dr.minimum(least, BAND_WIDTH * cone_radius(t))
        least, place = dr.select(lowest, here, least), dr.select(lowest, t, place)
        return ahead, here, there, least, place, i + 1

    zero = 0 * far
    first = gap(zero)
    start = zero, first, first, zero + dr.inf, zero, dr.uint32_array_t(type(zero))(0)
    return dr.while_loop(
        start,
        lambda t, before, here, least, place, i: active & (t < far) & (i < MAX_STEPS),
        take_step,
    )[4]
