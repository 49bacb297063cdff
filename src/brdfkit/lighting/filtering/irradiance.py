"""The light that a matte surface receives: a map of all directions, filtered by the cosine.

∫ L(ω) max(n·ω, 0) dω / π for every normal n: what a white Lambertian surface shows.
"""

import numpy as np

from brdfkit.lighting.filtering.paraboloid_levels import discs
from brdfkit.lighting.filtering.sphere_filter import convolve, halve

SIDE = 64  # texels: irradiance is smooth


def irradiance(picture):
    """Discs (2, SIDE, SIDE, channels) over normals, of radiance (height, 2 height, channels)."""
    while len(picture) > 4 * SIDE:
        picture = halve(picture)
    return discs(convolve(picture, lambda cos: np.maximum(cos, 0) / np.pi, np.pi / 2), SIDE)
