"""Converts directions on the hemisphere to angles and to half/difference coordinates, and back.

Directions are unit vectors (..., 3) of NumPy, float64, in the local frame with z along the normal.
`wi` and `wo` both point away from the surface, so that mirror directions are 180° apart in azimuth.
Half/difference coordinates are those of [Rusinkiewicz 1998].
"""

import numpy as np

from brdfkit.core.array_types import AnyArray, ArrayLike, FloatArray, IntArray


def from_angles(theta: ArrayLike, phi: ArrayLike) -> FloatArray:
    """Return unit vectors (..., 3) at the polar angle `theta` and the azimuth `phi` [rad].

    >>> from_angles(0.0, 0.0)
    array([0., 0., 1.])
    """
    theta, phi = np.broadcast_arrays(np.asarray(theta, float), np.asarray(phi, float))
    sin_theta = np.sin(theta)
    return np.stack([sin_theta * np.cos(phi), sin_theta * np.sin(phi), np.cos(theta)], axis=-1)


def to_angles(w: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Return polar angles in [0, π] and azimuths in (-π, π] [rad] of unit vectors (..., 3)."""
    w = np.asarray(w, float)
    return np.arctan2(np.hypot(w[..., 0], w[..., 1]), w[..., 2]), np.arctan2(w[..., 1], w[..., 0])


def normalize(w: ArrayLike) -> AnyArray:
    """Return the unit vectors (..., 3) along vectors (..., 3)."""
    w = np.asarray(w, float)
    return w / np.linalg.norm(w, axis=-1, keepdims=True)


def to_half_difference(wi: ArrayLike, wo: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return (theta_h, theta_d, phi_d) [rad] of direction pairs (..., 3), with phi_d in [0, 2π).

    theta_h is the polar angle of the half vector; theta_d and phi_d are the angles of `wi` to it.
    Exchanging `wi` and `wo` adds π to phi_d, so that a reciprocal BRDF has the period π in phi_d.
    `half_azimuth` gives the azimuth of the half vector, on which only an anisotropic BRDF depends.
    """
    wi, wo = np.asarray(wi, float), np.asarray(wo, float)
    h = normalize(wi + wo)
    theta_h, phi_h = to_angles(h)
    # Turn wi as the half vector is turned to the normal: by -phi_h about z, then -theta_h about y
    d = _rotate_y(rotate_z(wi, -phi_h), -theta_h)
    theta_d, phi_d = to_angles(d)
    return theta_h, theta_d, np.mod(phi_d, 2 * np.pi)


def cos_theta_h(wi: FloatArray, wo: FloatArray) -> FloatArray:
    """Return the cosine (n,) of theta_h, the half vector's angle to the normal, of pairs (n, 3)."""
    x, y, z = (wi + wo).T
    return z / np.sqrt(x * x + y * y + z * z)


def half_azimuth(wi: ArrayLike, wo: ArrayLike) -> FloatArray:
    """Return phi_h in [0, 2π) [rad], the azimuth of the half vector of direction pairs (..., 3)."""
    s = np.asarray(wi, float) + np.asarray(wo, float)
    return np.mod(np.arctan2(s[..., 1], s[..., 0]), 2 * np.pi)


def from_half_difference(
    theta_h: ArrayLike, theta_d: ArrayLike, phi_d: ArrayLike, phi_h: ArrayLike = 0.0
) -> tuple[FloatArray, FloatArray]:
    """Return direction pairs (wi, wo), each (..., 3), at half/difference angles [rad].

    A direction may lie below the surface, z < 0; the caller has to mask it.
    """
    theta_h, theta_d, phi_d, phi_h = np.broadcast_arrays(theta_h, theta_d, phi_d, phi_h)
    wi = _rotate_y(from_angles(theta_d, phi_d), theta_h)
    wo = _rotate_y(from_angles(theta_d, phi_d + np.pi), theta_h)
    return rotate_z(wi, phi_h), rotate_z(wo, phi_h)


def group_equal_pairs(wi: AnyArray, wo: AnyArray) -> tuple[IntArray, IntArray]:
    """Return the group (n,) of each pair of directions (n, 3), and the sizes of the groups.

    Pairs in a group are equal to six decimals.
    """
    pairs = np.concatenate([wi, wo], axis=1).round(6)
    _, group, counts = np.unique(pairs, axis=0, return_inverse=True, return_counts=True)
    return group.ravel(), counts


def rotate_z(w: FloatArray, angle: ArrayLike) -> FloatArray:
    """Turn vectors (..., 3) about the z axis by an angle [rad]."""
    c, s = np.cos(angle), np.sin(angle)
    x, y = w[..., 0], w[..., 1]
    return np.stack([c * x - s * y, s * x + c * y, w[..., 2]], axis=-1)


def _rotate_y(w: FloatArray, angle: ArrayLike) -> FloatArray:
    """Turn vectors (..., 3) about the y axis by an angle [rad]."""
    c, s = np.cos(angle), np.sin(angle)
    x, z = w[..., 0], w[..., 2]
    return np.stack([c * x + s * z, w[..., 1], -s * x + c * z], axis=-1)
