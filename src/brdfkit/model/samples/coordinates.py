"""Maps direction pairs to points, so that the BRDF has similar values at close points.

The neighbours of a sample are then those that resemble it. For an isotropic material the
coordinates are θ_h (the angle of the half vector to the normal), sin θ_d (θ_d is half the angle
between the directions) and |cos θ_i - cos θ_o|. The four pairs that are equivalent by reciprocity
and mirror symmetry become one point. For an anisotropic material the coordinates are the half
vector and the difference vector; a pair and its reciprocal pair become two points.
"""

import numpy as np

from brdfkit.core.array_types import AnyArray, ArrayLike
from brdfkit.core.geometry.directions import half_azimuth, to_half_difference

# Factors of the coordinates θ_h, sin θ_d and the third one. A highlight is narrow along θ_h and
# changes slowly with θ_d; retroreflection, at θ_d = 0, is narrow along both
HIGHLIGHT, RETROREFLECTION = (8.0, 1.0, 1.0), (4.0, 4.0, 4.0)


def to_isotropic_points(wi: AnyArray, wo: AnyArray, scales: ArrayLike = HIGHLIGHT) -> AnyArray:
    """Map direction pairs (n, 3) on an isotropic material to points (n, 3), times `scales`."""
    theta_h, theta_d, _ = to_half_difference(wi, wo)
    # The difference equals 2 sinθ_h sinθ_d |cos φ_d|, but needs no φ_d, undefined where θ_h = 0
    cosine_difference = np.abs(wi[:, 2] - wo[:, 2])
    return np.stack([theta_h, np.sin(theta_d), cosine_difference], axis=-1) * scales


def to_anisotropic_points(wi: AnyArray, wo: AnyArray) -> AnyArray:
    """Map direction pairs (n, 3) on an anisotropic material to points (n, 4)."""
    theta_h, theta_d, phi_d = to_half_difference(wi, wo)
    phi_h = half_azimuth(wi, wo)
    radius = HIGHLIGHT[0] * theta_h
    # The azimuth of the difference vector about the surface normal: near θ_h = 0, where φ_h is
    # undefined, it is well defined, while φ_d is not
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
    """Map direction pairs (n, 3) to points (n, 3), or (n, 4) for an anisotropic material."""
    return to_anisotropic_points(wi, wo) if anisotropic else to_isotropic_points(wi, wo)


def compute_sample_coordinates(wi: AnyArray, wo: AnyArray, anisotropic: bool) -> AnyArray:
    """Map samples at direction pairs (n, 3) to points (n, 3), or (2n, 4) if anisotropic.

    For an anisotropic material, the points of the pairs are followed by those of the reciprocal
    pairs, which have the same values of the BRDF.
    """
    points = compute_coordinates(wi, wo, anisotropic)
    return np.concatenate([points, compute_coordinates(wo, wi, True)]) if anisotropic else points
