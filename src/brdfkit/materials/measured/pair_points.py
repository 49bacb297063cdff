"""Direction pairs as points, whose distance tells how far the directions differ.

The distance of two points is 1/√2 to 3/2 of the angle [rad] by which the pairs' directions differ.
Of an isotropic material only the azimuth between wi and wo counts. Where this azimuth differs by δ
between two pairs, no common rotation brings them nearer to each other than
δ sin θi sin θo / √(sin² θi + sin² θo).
"""

import numpy as np


def points(wi, wo, anisotropic=False):
    """Direction pairs `wi`, `wo` (n, 3) as points (n, 4); of an anisotropic material (n, 6)."""
    if anisotropic:
        return np.concatenate([wi, wo], axis=-1)
    theta_i, theta_o = (np.arccos(np.clip(w[:, 2], -1, 1)) for w in (wi, wo))
    across_i, across_o = (w[:, 0] + 1j * w[:, 1] for w in (wi, wo))
    length = np.hypot(np.abs(across_i), np.abs(across_o))
    azimuth = across_i * across_o.conj() / np.maximum(length, 1e-12)
    return np.stack([theta_i, theta_o, azimuth.real, azimuth.imag], axis=-1)
