"""Vector functions for the formulas of models, for any type with x, y and z.

Directions are unit vectors in the local frame, z along the normal.
"""

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitMask, JitVector

# Directions with a smaller cosine count as below the horizon, so that 1/cos is finite in float32
HORIZON = 1e-6


def mask_below_horizon(w: JitVector, active: JitMask) -> tuple[JitVector, JitMask]:
    """Replace directions that are not above the surface by the normal, and make them inactive."""
    up = w.z > HORIZON
    return dr.select(up, w, type(w)(0, 0, 1)), active & up


def dot(a: JitVector, b: JitVector) -> JitFloat:
    """Return the dot product of two vectors."""
    return a.x * b.x + a.y * b.y + a.z * b.z


def normalise(w: JitVector) -> JitVector:
    """Return a vector divided by its length."""
    return w * dr.rsqrt(dot(w, w))


def half_vector(wi: JitVector, wo: JitVector) -> JitVector:
    """Return the unit vector halfway between two directions above the surface."""
    return normalise(wi + wo)


def cos_theta_d(wi: JitVector, wo: JitVector) -> JitFloat:
    """Return the cosine wi·h of the difference angle, between `wi` and the half vector h.

    It is computed as |wi + wo| / 2, since the terms of the dot product cancel at wo ≈ -wi.
    """
    s = wi + wo
    return 0.5 * dr.sqrt(dot(s, s))


def reflect(wi: JitVector, h: JitVector) -> JitVector:
    """Reflect `wi` about the unit vector `h`."""
    return 2 * dot(wi, h) * h - wi


def one_minus_dot(a: JitVector, b: JitVector) -> JitFloat:
    """Return 1 - a·b of unit vectors, accurate where they are close."""
    d = a - b
    return 0.5 * dot(d, d)


def polar_angle(w: JitVector) -> JitFloat:
    """Return the polar angle [rad] of a unit vector, accurate near the normal."""
    return dr.atan2(dr.sqrt(w.x * w.x + w.y * w.y), w.z)


def azimuth(w: JitVector) -> JitFloat:
    """Return the azimuth of a vector in [0, 2π) [rad]."""
    phi = dr.atan2(w.y, w.x)
    return dr.select(phi < 0, phi + 2 * dr.pi, phi)
