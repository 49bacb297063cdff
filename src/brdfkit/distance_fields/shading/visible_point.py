"""Finds the points where camera rays meet a field, with cones as wide as a sample of a pixel.

A cone ends where it touches the surface, so that no object is missed, however thin. Around its end
there is a ball without any object, from which shadows are traced. At a sharp edge, the normal of
such a large ball would be that of a rounded edge, and show false highlights. So the ray goes on to
a much smaller empty ball, and the normal is taken there. The shaded point is where the ray meets
the plane that touches the small ball, so that distances to lamps are exact. Objects look larger by
half a pixel's diagonal, divided by the root of the number of samples per pixel.

[Bálint et al. 2019, section 2.7]
"""

from dataclasses import dataclass
from math import sqrt
from typing import Any

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitMask, MitsubaObject
from brdfkit.core.jit.loops import record_loops
from brdfkit.distance_fields.node import Node
from brdfkit.distance_fields.tracing.cone_tracing import cone_trace
from brdfkit.distance_fields.tracing.hits import normal, reattach
from brdfkit.mitsuba_bridge.surface_points import make_interaction

NORMAL_STEP = 10.0  # step of the finite differences that give normals, in units of `precision`
SMALL_BALL = 1 / 8  # the radius of the small ball, as a share of that of the large one
# The least cosine between ray and normal, so that the way from a ball to the surface stays short
LEAST_COSINE = 0.1


@dataclass(frozen=True)
class VisiblePoint:
    """The point where a camera ray meets a field.

    si : `mi.SurfaceInteraction3f`, on the surface.
    middle, ball : the centre and the radius of a ball near it that contains no object.
    found : Bool, whether the ray meets the field at all.
    field : the distance field.
    """

    si: Any
    middle: Any
    ball: Any
    found: Any
    field: Node


@record_loops
def find_visible_point(
    field: Node, ray: MitsubaObject, far: JitFloat, precision: JitFloat, active: JitMask
) -> VisiblePoint:
    """Return where each `mi.RayDifferential3f` meets a field.

    The result has derivatives with respect to the field's parameters.

    far : the distance along rays at which they end.
    precision : the radius of the thinnest cones.
    """
    radius, tangent = compute_ray_cone(ray)
    settings = {"radius": radius + precision, "tangent": tangent, "active": active}
    f, lipschitz = field.distance, field.lipschitz
    hit = cone_trace(f, ray.o, ray.d, far, lipschitz=lipschitz, precision=precision / 4, **settings)
    t = dr.select(hit.found, hit.t, 0)
    if dr.grad_enabled(f(ray(t))):
        t = reattach(f, ray.o, ray.d, t)
    ball = dr.maximum(hit.distance, precision / 2)  # also rays that meet nothing need a radius > 0
    with dr.suspend_grad():
        end = dr.minimum(far, t + ball / LEAST_COSINE)
        close = dr.maximum(SMALL_BALL * ball, precision / 4)
        settings = {"lipschitz": lipschitz, "precision": close, "t_min": t, "active": hit.found}
        closer = cone_trace(f, ray.o, ray.d, end, **settings)
        gap = dr.select(closer.found, closer.distance, ball)
        ahead = dr.select(closer.found, closer.t - t, 0)
    n = normal(f, ray(t + ahead), dr.maximum(gap, NORMAL_STEP * precision))
    ahead = ahead + dr.detach(gap / dr.maximum(-dr.dot(n, ray.d), LEAST_COSINE))
    si = make_interaction(ray, t, ray(t + ahead), n, hit.found)
    return VisiblePoint(si, ray(t), ball, hit.found, field)


def compute_ray_cone(ray: MitsubaObject) -> tuple[JitFloat, JitFloat]:
    """Return the first radius and the slope of the cone around each ray, from its differentials.

    Both are 0 for rays without differentials.
    """
    if not ray.has_differentials:
        return 0.0, 0.0
    across = dr.maximum(dr.norm(ray.o_x - ray.o), dr.norm(ray.o_y - ray.o))
    turned = dr.maximum(dr.norm(ray.d_x - ray.d), dr.norm(ray.d_y - ray.d))
    return dr.detach(across) / sqrt(2), dr.detach(turned) / sqrt(2)
