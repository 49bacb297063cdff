"""`monte_carlo`: the reference for all other methods, by many single rays to the light.

Rays lead from the point itself to the spherical light, whose solid angle they share alike: with a
Halton sequence u in base 2, a ray has cos θ = 1 - u (1 - cos α) with the cone's axis, and sin α =
r / d for the light's radius r at the distance d. Another sequence in base 3 turns it about the
axis. A ray ends on the light's surface. So the reference knows nothing of the ball about the point
and of the straight edge, which the other methods assume.

[Bálint et al. 2019, section 3.3]
"""

from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.array_types import FloatArray, JitFloat, JitInt, JitVector
from brdfkit.core.jit.padding import pad
from brdfkit.distance_fields.shadows.cone import LARGEST_SINE, LightCone
from brdfkit.distance_fields.shadows.field import distance_function, lipschitz_bound
from brdfkit.distance_fields.shadows.shadow import Shadow

MAX_STEPS = 4096  # the most steps along a ray, many for rays that graze a plane


def compute_monte_carlo_shadow(
    field: Any, cone: LightCone, rays: int = 64, hit: float = 1e-3, skip: int = 0
) -> Shadow:
    """Return the share of `rays` that reach the light; `r` and `t` of the result are NaN.

    A ray meets an object where the distance is less than `hit` times the radius of the cone. The
    first `skip` rays of the sequence are left out, for a result that does not depend on them.
    """
    cone = cone.make_detached()
    Float = type(cone.d)
    UInt = dr.uint32_array_t(Float)
    xs, ys = (Float(pad(q)) for q in halton_points_in_disc(rays, skip))
    zero = 0 * cone.d

    def add_ray(k: JitInt, lit: JitFloat, evaluations: JitFloat) -> tuple[Any, ...]:
        x, y = dr.gather(Float, xs, k), dr.gather(Float, ys, k)
        clearance, n = trace_ray(field, cone, *choose_ray(cone, x, y), hit)
        through = dr.select(clearance > 0, 1, dr.select(clearance <= 0, 0, dr.nan))
        return k + 1, lit + through, evaluations + n

    with dr.suspend_grad():
        first = dr.zeros(UInt, dr.width(zero))
        _, lit, evaluations = dr.while_loop(
            (first, zero, zero), lambda k, lit, evaluations: k < rays, add_ray
        )
    return Shadow(lit / rays, zero + dr.nan, zero + dr.nan, evaluations)


def choose_ray(cone: LightCone, x: JitFloat, y: JitFloat) -> tuple[JitVector, JitFloat]:
    """Return the direction of a ray to the light and its length, for a point (x, y) of a disc.

    Points that are uniform over the unit disc give rays that are uniform over the solid angle.
    """
    radius = cone.R_1 * dr.rsqrt(1 + cone.tan * cone.tan)
    sin2 = dr.square(dr.minimum(radius / cone.d, LARGEST_SINE))
    rise = sin2 / (1 + dr.sqrt(1 - sin2))  # 1 - cos α, without a difference of nearly equal numbers
    cos = 1 - (x * x + y * y) * rise
    a, b = cone.basis
    direction = cone.axis * cos + (a * x + b * y) * dr.sqrt(rise * (1 + cos))
    half_chord = dr.safe_sqrt(dr.square(radius) - dr.square(cone.d) * (1 - cos * cos))
    return direction, cone.d * cos - half_chord


def trace_ray(
    field: Any, cone: LightCone, direction: JitVector, length: JitFloat, hit: float
) -> tuple[JitFloat, JitFloat]:
    """Trace a ray from the start of a cone; return its last clearance and its number of steps.

    The clearance is the distance less the `hit` distance, 0 or less where the ray met an object.
    """
    f, lipschitz = distance_function(field), lipschitz_bound(field)
    zero = 0 * cone.d

    def take_step(t: JitFloat, clearance: JitFloat, i: JitFloat) -> tuple[JitFloat, ...]:
        F = f(cone.start + direction * t)
        return t + dr.maximum(F, 0) / lipschitz, F - hit * cone.radius(t), i + 1

    _, clearance, n = dr.while_loop(
        (zero, zero + 1, zero),
        lambda t, clearance, i: (t < length) & (clearance > 0) & (i < MAX_STEPS),
        take_step,
    )
    return clearance, n


def halton_points_in_disc(n: int, skip: int = 0) -> tuple[FloatArray, FloatArray]:
    """Return x (n,) and y (n,) of the Halton points after `skip`, uniform over the unit disc."""
    from scipy.stats.qmc import Halton

    # The first of Halton's points is left out, as it is the corner (0, 0)
    u, phi = Halton(2, scramble=False).random(skip + n + 1)[skip + 1 :].T
    return np.sqrt(u) * np.cos(2 * np.pi * phi), np.sqrt(u) * np.sin(2 * np.pi * phi)
