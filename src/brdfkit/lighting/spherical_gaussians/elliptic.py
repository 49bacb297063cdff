"""The method `elliptic` fits an anisotropic lobe to each view, as n round lobes over its ellipse.

The lobe of `single_lobe.py` is round, but the highlights of brushed metal, and of any material at
grazing views, are not. Here the samples that belong to that lobe are fitted with an anisotropic
spherical Gaussian

    G(v) = max(v·z, 0) e^(-λ (v·x)² - μ (v·y)²)

with an orthonormal frame x, y, z and bandwidths λ, μ > 0 [Xu et al. 2013]. Projected along z, it is
a Gaussian of the plane, whose second moments give λ and μ. It is replaced by round, narrower lobes
at points of its ellipse; three or more of them have the same second moments in sum.
"""

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.geometry.directions import normalize
from brdfkit.lighting.spherical_gaussians.one_view import OneView, ViewLobes
from brdfkit.lighting.spherical_gaussians.single_lobe import fit_lobe
from brdfkit.lighting.spherical_gaussians.von_mises_fisher import tangents


def fit_elliptic_lobes(grid: list[list[OneView]], lobes: int) -> list[list[ViewLobes]]:
    """Fit an anisotropic lobe to each view of a `grid`, by `lobes` round ones of equal weight.

    For each azimuth, the grid has a list of views by increasing polar angle.
    """
    return [[_spread_over_ellipse(one, lobes) for one in views] for views in grid]


def fit_anisotropic_gaussian(x: FloatArray, weights: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Fit an anisotropic spherical Gaussian to directions `x` (n, 3) with `weights` (n,).

    Returns its frame (3, 3), with the rows x, y and z, and its bandwidths (2,) along x and y, from
    the second moments of the directions.
    """
    axis = normalize(weights @ x)
    plane = np.array(tangents(axis))
    flat = x @ plane.T
    moments = (weights[:, None] * flat).T @ flat / weights.sum()
    bandwidths, directions = np.linalg.eigh(np.linalg.inv(2 * moments))
    return np.array([*directions.T @ plane, axis]), bandwidths


def _spread_over_ellipse(one: OneView, n: int) -> ViewLobes:
    """Fit an anisotropic lobe to one view, and spread `n` round lobes over its ellipse."""
    part, share, *_ = fit_lobe(one)
    x, weights = one.samples()
    frame, bandwidths = fit_anisotropic_gaussian(x, weights * share)
    light = one.energy.sum(axis=0)
    variances = 1 / (2 * bandwidths)  # variances along the x and y axes of the lobe's ellipse
    # The ellipse is made of round lobes. Their variance is half the ellipse's mean variance, but
    # smaller than the ellipse's variance along its shorter axis
    kernel = min(np.sqrt(variances.prod()) / 2, 0.9 * variances.min())
    # Spread the lobes' centres by the symmetric root of the rest of the variance. It changes
    # smoothly from view to view, even where the ellipse's longer axis becomes the shorter one
    plane = np.array(tangents(frame[2]))
    turn = frame[:2] @ plane.T
    root = turn.T @ np.diag(np.sqrt(variances - kernel)) @ turn
    u = _make_normal_points(n) @ root @ plane
    height = np.sqrt(np.maximum(1 - (u**2).sum(axis=1), 0))
    axes = u + height[:, None] * frame[2]
    weights = np.repeat(part * light[None] / n, n, axis=0)
    return one.diffuse + (1 - part) * light, weights, normalize(axes), np.full(n, 1 / kernel)


def _make_normal_points(n: int) -> FloatArray:
    """Return `n` evenly spread points (n, 2) of the standard normal distribution of the plane.

    Their mean is exactly 0 and their covariance the identity.
    """
    m = np.arange(n)
    radius = np.sqrt(-2 * np.log(1 - (m + 0.5) / n))
    angle = np.pi * (np.sqrt(5) - 1) * m
    points = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)
    points -= points.mean(axis=0)
    variances, axes = np.linalg.eigh(points.T @ points / n)
    return points @ axes / np.sqrt(np.maximum(variances, 1e-12)) @ axes.T
