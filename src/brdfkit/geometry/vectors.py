"""Directions in a formula: anything with x, y, z, z along the normal, in any precision."""

import drjit as dr

# Directions this close to the horizon (cosine) count as below it: 1/cos stays finite in float32
HORIZON = 1e-6


def above_horizon(w, active):
    """The direction, or the normal where it is not above the surface, which turns inactive."""
    up = w.z > HORIZON
    return dr.select(up, w, type(w)(0, 0, 1)), active & up


def dot(a, b):
    """Scalar product."""
    return a.x * b.x + a.y * b.y + a.z * b.z


def half_vector(wi, wo):
    """Unit vector halfway between two directions above the surface."""
    s = wi + wo
    return s * dr.rsqrt(dot(s, s))


def cos_theta_d(wi, wo):
    """Cosine of the difference angle, wi·h; as a dot product its terms cancel where wo ≈ -wi."""
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
    """Angle to the normal [rad], accurate about it."""
    return dr.atan2(dr.sqrt(w.x * w.x + w.y * w.y), w.z)


def azimuth(w):
    """Azimuth in [0, 2π) [rad]."""
    phi = dr.atan2(w.y, w.x)
    return dr.select(phi < 0, phi + 2 * dr.pi, phi)
