"""Coordinates of direction pairs: the closer two points are, the more alike are the BRDF's values.

An isotropic material has the coordinates θ_h, sin θ_d and |cos θ_i - cos θ_o|: the four pairs that
are equivalent by reciprocity and mirror symmetry are one point. An anisotropic material has the
half vector and the difference vector: a pair and its reciprocal pair are two points.
"""

import numpy as np

from brdfkit.core.array_types import AnyArray, ArrayLike
from brdfkit.core.geometry.directions import half_azimuth, to_half_difference

# Scales of θ_h, sin θ_d and the third coordinate. A highlight is narrow along θ_h and changes
# slowly with θ_d; retroreflection, at θ_d = 0, is narrow along both
HIGHLIGHT, RETROREFLECTION = (8.0, 1.0, 1.0), (4.0, 4.0, 4.0)


def isotropic_coordinates(wi: AnyArray, wo: AnyArray, scales: ArrayLike = HIGHLIGHT) -> AnyArray:
    """Return points (n, 3) of direction pairs (n, 3) on an isotropic material."""
    theta_h, theta_d, _ = to_half_difference(wi, wo)
    # Equals 2 sinθ_h sinθ_d |cos φ_d|: φ_d itself is undefined at the mirror direction
    apart = np.abs(wi[:, 2] - wo[:, 2])
    return np.stack([theta_h, np.sin(theta_d), apart], axis=-1) * scales


def anisotropic_coordinates(wi: AnyArray, wo: AnyArray) -> AnyArray:
    """Return points (n, 4) of direction pairs (n, 3) on an anisotropic material."""
    theta_h, theta_d, phi_d = to_half_difference(wi, wo)
    phi_h = half_azimuth(wi, wo)
    radius = HIGHLIGHT[0] * theta_h
    # The azimuth of the difference vector about the surface normal, since near θ_h = 0 φ_d alone
    # turns with φ_h, which is undefined there
    azimuth = phi_d + phi_h
    return np.stack(
        [
            radius * np.cos(phi_h),
            radius * np.sin(phi_h),
            np.sin(theta_d) * np.cos(azimuth),
            np.sin(theta_d) * np.sin(azimuth),
        ],
        axis=-1,
    )


def compute_coordinates(wi: AnyArray, wo: AnyArray, anisotropic: bool) -> AnyArray:
    """Return points of direction pairs (n, 3): (n, 3), or (n, 4) on an anisotropic material."""
    return anisotropic_coordinates(wi, wo) if anisotropic else isotropic_coordinates(wi, wo)


def compute_sample_coordinates(wi: AnyArray, wo: AnyArray, anisotropic: bool) -> AnyArray:
    """Return points of samples at direction pairs (n, 3): (n, 3), or (2n, 4) if anisotropic.

    An anisotropic material has the points of the pairs in both orders, one set behind the other.
    """
    points = compute_coordinates(wi, wo, anisotropic)
    return np.concatenate([points, compute_coordinates(wo, wi, True)]) if anisotropic else points
