"""Wang's warp: a lobe of facet normals, or half vectors, as a lobe of light directions.

    i = 2 (o·h) h - o,  κ_i = κ_h / (4 |o·h|)

of the half vector h at the lobe's axis, for a view o: the density of i is that of h over 4 |o·h|.
The warped lobe is stretched along the plane of incidence in truth; here it stays round, which is
the error of the warp, above all at grazing angles. [Wang et al. 2009]
"""

import numpy as np

from brdfkit.core.geometry.directions import normalize

LEAST = 0.01  # |o·h| of a lobe that is hardly seen: κ stays finite


def beckmann(m):
    """κ = 2 / m² of the facet normals of Beckmann's and Ward's lobe of roughness m."""
    return 2 / np.asarray(m, float) ** 2


def to_light(axes, kappa, view):
    """Axes (..., 3) and κ (...) of lobes of half vectors as those of light, for a `view` (3,)."""
    cosine = axes @ view
    return 2 * cosine[..., None] * axes - view, kappa / (4 * np.maximum(np.abs(cosine), LEAST))


def to_half_vectors(axes, kappa, view):
    """Axes and κ of lobes of light as those of half vectors: the inverse of `to_light`."""
    halves = normalize(axes + view)
    return halves, kappa * 4 * np.maximum(np.abs(halves @ view), LEAST)
