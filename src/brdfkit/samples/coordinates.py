"""Coordinates of direction pairs: the closer two points are, the more alike is a BRDF there.

Of an isotropic material θ_h, sin θ_d and |cos θ_i - cos θ_o|: reciprocity and the mirror symmetry
put the four equivalent pairs on one point. Of an anisotropic one the half vector and the
difference vector; its two orders of directions are two points.
"""

import numpy as np

from brdfkit.geometry.directions import half_azimuth, to_half_difference

# What a unit of theta_h, sinθ_d and the third coordinate counts. A highlight is narrow along
# theta_h and changes slowly with theta_d; retroreflection, at theta_d = 0, is narrow along both.
HIGHLIGHT, RETROREFLECTION = (8.0, 1.0, 1.0), (4.0, 4.0, 4.0)


def isotropic_coordinates(wi, wo, scales=HIGHLIGHT):
    """Points (n, 3): the closer, the more alike is an isotropic BRDF."""
    theta_h, theta_d, _ = to_half_difference(wi, wo)
    # That is 2 sinθ_h sinθ_d |cos φ_d|: at the mirror direction phi_d means nothing
    apart = np.abs(wi[:, 2] - wo[:, 2])
    return np.stack([theta_h, np.sin(theta_d), apart], axis=-1) * scales


def anisotropic_coordinates(wi, wo):
    """Points (n, 4): the closer, the more alike is any BRDF."""
    theta_h, theta_d, phi_d = to_half_difference(wi, wo)
    phi_h = half_azimuth(wi, wo)
    radius = HIGHLIGHT[0] * theta_h
    # The difference vector in the surface's frame: phi_d alone turns with phi_h at the normal
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
