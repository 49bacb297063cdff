"""Cone tracing: where a cone, not only its axis, first meets a surface.

The distance less the cone's radius, over its own bound 1 + |tan α|, is a distance again, that
sphere tracing takes [Bálint et al. 2019, chapter 2]:

    F(t) = (f(o + t d) - ρ(t)) / (1 + |tan α|),   ρ(t) = R₀ + t tan α
"""

import drjit as dr
import numpy as np

from brdfkit.distance_fields.hits import Hit, start


def cone_trace(
    distance,
    o,
    d,
    t_max,
    *,
    radius=0.0,
    tangent=0.0,
    slack=0.0,
    lipschitz=1.0,
    precision=1e-4,
    steps=512,
    active=True,
):
    """Where cones about the axes o + t d first touch the surface of `distance`.

    A cone has the `radius` R₀ at t = 0 and widens by `tangent` tan α, which may be negative. It
    stops where f ≤ (1 + slack) ρ + precision; as its steps end at ρ, nothing that reaches into the
    cone is passed, however thin. What lies between ρ and (1 + slack) ρ may be found or not, and the
    steps are the fewer the larger `slack` is. `distance` of the `Hit` is f / lipschitz at the axis:
    the radius of an empty ball there.
    """
    with dr.suspend_grad():
        t, count = start(o, 0.0)

        def enough(t):
            return (1.0 + slack) * (radius + t * tangent) + precision

        def goes_on(t, f, i):
            return active & (f > enough(t)) & (t < t_max) & (i < steps)

        def step(t, f, i):
            t = t + (f - (radius + t * tangent)) / (1.0 + abs(tangent))
            return t, distance(o + d * t) / lipschitz, i + 1

        first = distance(o + d * t) / lipschitz
        t, f, count = dr.while_loop((t, first, count + 1), goes_on, step)
        return Hit(t, active & (f <= enough(t)) & (t < t_max), f, count)


def pixel_tangent(fov, pixels):
    """tan α of the cone that covers a pixel, up to its corners, of a perspective picture.

    `fov` [degrees] is the angle of view across so many `pixels`. Cones of all pixels leave no gap,
    so that no object between them is missed.
    """
    return float(np.sqrt(2) * np.tan(np.radians(fov) / 2) / pixels)
