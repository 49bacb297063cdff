"""One anisotropic lobe per view, as n round lobes spread over its ellipse.

The lobe of `single` is round; those of brushed metal, and of any material at grazing views, are
not. Here the samples that belong to it give an `AnisotropicGaussian`, whose points carry round
lobes, narrower than it is across: their sum has its second moments, from 3 lobes on.
"""

import numpy as np

from brdfkit.core.geometry.directions import normalize
from brdfkit.lighting.spherical_gaussians import anisotropic
from brdfkit.lighting.spherical_gaussians.single import one_lobe
from brdfkit.lighting.spherical_gaussians.von_mises_fisher import tangents


def elliptic(grid, lobes):
    """(diffuse, weights, axes, κ) of each `OneView` of a `grid`: `lobes` of equal weight and κ."""
    return [[_spread(one, lobes) for one in views] for views in grid]


def _spread(one, n):
    part, share, *_ = one_lobe(one)
    x, weights = one.samples()
    lobe = anisotropic.fit(x, weights * share)
    light = one.energy.sum(axis=0)
    variances = 1 / (2 * lobe.bandwidths)  # along the lobe's x and y
    # The kernels have half of a round lobe's variance, and less than that across a narrow one
    kernel = min(np.sqrt(variances.prod()) / 2, 0.9 * variances.min())
    # The symmetric root of what the kernels leave, so that points move smoothly from view to view,
    # where the axes of the ellipse may change places
    plane = np.array(tangents(lobe.frame[2]))
    turn = lobe.frame[:2] @ plane.T
    root = turn.T @ np.diag(np.sqrt(variances - kernel)) @ turn
    u = _standard_points(n) @ root @ plane
    height = np.sqrt(np.maximum(1 - (u**2).sum(axis=1), 0))
    axes = u + height[:, None] * lobe.frame[2]
    weights = np.repeat(part * light[None] / n, n, axis=0)
    return one.diffuse + (1 - part) * light, weights, normalize(axes), np.full(n, 1 / kernel)


def _standard_points(n):
    """n points (n, 2) of a normal distribution, whose mean is 0 and whose covariance is 1."""
    m = np.arange(n)
    radius = np.sqrt(-2 * np.log(1 - (m + 0.5) / n))
    angle = np.pi * (np.sqrt(5) - 1) * m
    points = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)
    points -= points.mean(axis=0)
    variances, axes = np.linalg.eigh(points.T @ points / n)
    return points @ axes / np.sqrt(np.maximum(variances, 1e-12)) @ axes.T
