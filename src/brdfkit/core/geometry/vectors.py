"""Vector functions for the formulas of models: on anything with x, y, z, in any precision.

Directions are unit vectors in the local frame, z along the normal.
"""

import drjit as dr

# Directions this close to the horizon (cosine) count as below it: 1/cos stays finite in float32
HORIZON = 1e-6


def mask_below_horizon(w, active):
    """`w` and `active`; where `w` is not above the surface, the normal and False."""
    up = w.z > HORIZON
    return dr.select(up, w, type(w)(0, 0, 1)), active & up


def dot(a, b):
    """Dot product."""
    return a.x * b.x + a.y * b.y + a.z * b.z


def half_vector(wi, wo):
    """Unit vector halfway between two directions above the surface."""
    s = wi + wo
    return s * dr.rsqrt(dot(s, s))


def cos_theta_d(wi, wo):
    """Cosine of the difference angle, wi·h; the terms of that dot product cancel at wo ≈ -wi."""
    s = wi + wo
    return 0.5 * dr.sqrt(dot(s, s))


def reflect(wi, h):
    """Mirror image of `wi` about `h`."""
    return 2 * dot(wi, h) * h - wi


def one_minus_dot(a, b):
    """1 - a·b of unit vectors, accurate where they are close."""
    d = a - b
    return 0.5 * dot(d, d)


def angle(w):
    """Polar angle [rad], accurate near the normal."""
    return dr.atan2(dr.sqrt(w.x * w.x + w.y * w.y), w.z)


def azimuth(w):
    """Azimuth in [0, 2π) [rad]."""
    phi = dr.atan2(w.y, w.x)
    return dr.select(phi < 0, phi + 2 * dr.pi, phi)
