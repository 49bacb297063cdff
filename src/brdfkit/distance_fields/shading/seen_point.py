"""Where camera rays meet a field: by cones as wide as a sample's part of a pixel.

A cone ends where it touches the surface, so that no object is missed, thin as it may be. Shadows
begin at the empty ball about its end. Before a sharp edge such a ball sees a round one, which would
glint; so the ray goes on to where a much smaller ball is, which has the normal. What is shaded lies
ahead, where the ray meets the plane that touches that one, so that lamps are as far away as they
are. Objects look larger by half a pixel's diagonal over the root of the samples per pixel.

[Bálint et al. 2019, section 2.7]
"""

from dataclasses import dataclass
from math import sqrt
from typing import Any

import drjit as dr

from brdfkit.core.jit.loops import recorded
from brdfkit.distance_fields.tracing.cone_tracing import cone_trace
from brdfkit.distance_fields.tracing.hits import reattach
from brdfkit.distance_fields.tracing.normals import normal
from brdfkit.distance_fields.tracing.sphere_tracing import sphere_trace
from brdfkit.mitsuba_bridge.surface_points import interaction

FINEST = 10.0  # over `precision`: half of the differences of normals; less than all details
CLOSE = 1 / 8  # the smaller ball over the first
SLANTED = 0.1  # the cosine to the surface below which a ray is taken no further


@dataclass(frozen=True)
class SeenPoint:
    """What a camera ray meets.

    si : `mi.SurfaceInteraction3f`, on the surface.
    middle, ball : the centre and the radius of an empty ball close to it.
    found : Bool, whether the ray meets the field at all.
    """

    si: Any
    middle: Any
    ball: Any
    found: Any


@recorded
def seen_point(field, ray, far, precision, active):
    """The `SeenPoint` of each `mi.RayDifferential3f`, with derivatives by the field's parameters.

    far : where rays end.
    precision : the radius of the thinnest cones.
    """
    radius, tangent = cone_of(ray)
    settings = {"radius": radius + precision, "tangent": tangent, "active": active}
    f, lipschitz = field.distance, field.lipschitz
    hit = cone_trace(f, ray.o, ray.d, far, lipschitz=lipschitz, precision=precision / 4, **settings)
    t = dr.select(hit.found, hit.t, 0)
    if dr.grad_enabled(f(ray(t))):
        t = reattach(f, ray.o, ray.d, t)
    ball = dr.maximum(hit.distance, precision / 2)  # of rays that meet nothing
    with dr.suspend_grad():
        end, close = dr.minimum(far, t + ball / SLANTED), dr.maximum(CLOSE * ball, precision / 4)
        settings = {"lipschitz": lipschitz, "precision": close, "t_min": t, "active": hit.found}
        closer = sphere_trace(f, ray.o, ray.d, end, **settings)
        gap = dr.select(closer.found, closer.distance, ball)
        ahead = dr.select(closer.found, closer.t - t, 0)
    n = normal(f, ray(t + ahead), dr.maximum(gap, FINEST * precision))
    ahead = ahead + dr.detach(gap / dr.maximum(-dr.dot(n, ray.d), SLANTED))
    return SeenPoint(interaction(ray, t, ray(t + ahead), n, hit.found), ray(t), ball, hit.found)


def cone_of(ray):
    """R₀ and tan α of the cone about a ray with differentials; 0 and 0 of one without."""
    if not ray.has_differentials:
        return 0.0, 0.0
    across = dr.maximum(dr.norm(ray.o_x - ray.o), dr.norm(ray.o_y - ray.o))
    turned = dr.maximum(dr.norm(ray.d_x - ray.d), dr.norm(ray.d_y - ray.d))
    return dr.detach(across) / sqrt(2), dr.detach(turned) / sqrt(2)
