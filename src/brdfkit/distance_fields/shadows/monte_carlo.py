"""`monte_carlo`: the reference for all other methods, by many single rays to the light.

The rays go through Halton's points of the cone's disc. A point lies at the distance √u from the
centre and at the angle φ; u is a Halton sequence in base 2, and φ one in base 3. A ray leads from
the section at the surface point to the section at the light, on a line through the cone's apex.

[Bálint et al. 2019, section 3.3]
"""

from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.array_types import FloatArray, JitFloat, JitInt
from brdfkit.core.jit.padding import pad
from brdfkit.distance_fields.shadows.cone import LightCone
from brdfkit.distance_fields.shadows.field import distance_function, lipschitz_bound
from brdfkit.distance_fields.shadows.shadow import Shadow

MAX_STEPS = 512  # the most steps along a ray


def compute_monte_carlo_shadow(
    field: Any, cone: LightCone, rays: int = 64, hit: float = 1e-3
) -> Shadow:
    """Return the share of `rays` that reach the light; `r` and `t` of the result are NaN.

    A ray meets an object where the distance is less than `hit` times the radius of the cone.
    """
    cone = cone.make_detached()
    Float = type(cone.d)
    UInt = dr.uint32_array_t(Float)
    xs, ys = (Float(pad(q)) for q in halton_points_in_disc(rays))
    zero = 0 * cone.d

    def add_ray(k: JitInt, lit: JitFloat, evaluations: JitFloat) -> tuple[Any, ...]:
        x, y = dr.gather(Float, xs, k), dr.gather(Float, ys, k)
        clearance, n = trace_ray(field, cone, x, y, hit)
        through = dr.select(clearance > 0, 1, dr.select(clearance <= 0, 0, dr.nan))
        return k + 1, lit + through, evaluations + n

    with dr.suspend_grad():
        first = dr.zeros(UInt, dr.width(zero))
        _, lit, evaluations = dr.while_loop(
            (first, zero, zero), lambda k, lit, evaluations: k < rays, add_ray
        )
    return Shadow(lit / rays, zero + dr.nan, zero + dr.nan, evaluations)


def trace_ray(
    field: Any, cone: LightCone, x: JitFloat, y: JitFloat, hit: float
) -> tuple[JitFloat, JitFloat]:
    """Trace the ray through (x, y) of the cone's disc; return its last clearance and step count.

    The clearance is the distance less the `hit` distance, 0 or less where the ray met an object.
    """
    f, tan = distance_function(field), cone.tan
    speed = lipschitz_bound(field) * dr.sqrt(1 + tan * tan * (x * x + y * y))
    zero = 0 * cone.d

    def take_step(t: JitFloat, clearance: JitFloat, i: JitFloat) -> tuple[JitFloat, ...]:
        F = f(cone.disc_point(t, x, y))
        return t + dr.maximum(F, 0) / speed, F - hit * cone.radius(t), i + 1

    _, clearance, n = dr.while_loop(
        (zero, zero + 1, zero),
        lambda t, clearance, i: (t < cone.d) & (clearance > 0) & (i < MAX_STEPS),
        take_step,
    )
    return clearance, n


def halton_points_in_disc(n: int) -> tuple[FloatArray, FloatArray]:
    """Return x (n,) and y (n,) of the first Halton points, uniform over the unit disc."""
    from scipy.stats.qmc import Halton

    # The first of Halton's points is left out, as it is the corner (0, 0)
    u, phi = Halton(2, scramble=False).random(n + 1)[1:].T
    return np.sqrt(u) * np.cos(2 * np.pi * phi), np.sqrt(u) * np.sin(2 * np.pi * phi)
