"""The methods `warped` and `kde` fit one lobe to each view, or n sharper lobes in its place.

The thesis derives the lobe from the roughness of a model. Here it is fitted to the BRDF, so that
any material has one. It is fitted together with a cosine, as a mixture of the two, so that light
far from the lobe is added to the diffuse part and does not widen the lobe.

`kde` replaces the lobe by a kernel density estimate on the sphere: a sum of n kernels, which are
lobes about points drawn from it. García-Portugués's rule of thumb gives the kernels' width. They
blur: from a lobe of concentration κ, the sum has only about κ / (1 + n^(-1/3)). The thesis draws
the points from the lobe itself; here a sharper lobe is drawn from, so that the sum is as wide as
the lobe.

[Ergun 2015, section 8.6]; [García-Portugués 2013]
"""

from __future__ import annotations

import numpy as np

from brdfkit.core.array_types import AnyArray, ArrayLike, FloatArray
from brdfkit.lighting.spherical_gaussians import von_mises_fisher as vmf
from brdfkit.lighting.spherical_gaussians.one_view import OneView, ViewLobes

STEPS = 50  # steps of expectation maximisation in the fit of a lobe


def fit_warped_lobes(grid: list[list[OneView]], lobes: int) -> list[list[ViewLobes]]:
    """Fit one lobe to each view of a `grid`; the number of `lobes` is ignored.

    For each azimuth, the grid has a list of views by increasing polar angle.
    """
    return [[_fit_split_lobes(one, 1) for one in views] for views in grid]


def fit_kde_lobes(grid: list[list[OneView]], lobes: int) -> list[list[ViewLobes]]:
    """Fit one lobe to each view of a `grid`, and split it into as many sharper ones as `lobes`.

    For each azimuth, the grid has a list of views by increasing polar angle.
    """
    return [[_fit_split_lobes(one, lobes) for one in views] for views in grid]


def _fit_split_lobes(one: OneView, n: int) -> ViewLobes:
    """Fit a lobe to one view, and split it into `n` lobes of equal weight.

    Light that does not belong to the lobe is added to the diffuse part.
    """
    part, _, axis, kappa = fit_lobe(one)
    light = one.energy.sum(axis=0)
    axes, kappas = split_lobe(axis, kappa, n) if n > 1 else (axis[None], np.array(kappa))
    weights = np.repeat(part * light[None] / n, n, axis=0)
    return one.diffuse + (1 - part) * light, weights, axes, np.full(n, kappas)


def fit_lobe(one: OneView) -> tuple[float, FloatArray, FloatArray, float]:
    """Fit a mixture of one lobe and a cosine to the glossy part of a view.

    Returns the lobe's part of the light, its share (m,) of each of `one.samples()`, its axis and
    its concentration κ. The fit begins with a narrow lobe at the brightest direction.
    """
    x, weights = one.samples()
    brightest = one.glossy.mean(axis=1).argmax()
    axis = one.directions[brightest]
    kappa = 2 * np.pi * one.glossy[brightest].mean() / max(one.energy.sum(axis=0).mean(), 1e-9)
    part = 0.9
    for _ in range(STEPS):
        lobe = part * np.exp(vmf.log_density(x @ axis, kappa))
        share = lobe / (lobe + (1 - part) * x[:, 2] / np.pi)
        part = weights @ share / weights.sum()
        mean = (weights * share) @ x / (weights @ share)
        axis, kappa = mean / np.linalg.norm(mean), vmf.solve_kappa(np.linalg.norm(mean))
    return part, share, axis, kappa


def kernel_bandwidth(kappa: ArrayLike, n: int) -> AnyArray:
    """Return the bandwidth h of a kernel density estimate from `n` points of a lobe.

    `kappa` is the lobe's concentration; the kernels have the concentration 1 / h².
    [García-Portugués 2013]

    >>> round(float(kernel_bandwidth(50.0, 8)), 6)
    0.100166
    """
    k = np.asarray(kappa, float)
    # Numerator and denominator are multiplied by e^(-2κ), to avoid overflow
    sinh_squared = (np.expm1(-2 * k) / 2) ** 2
    sinh_twice, cosh_twice = -np.expm1(-4 * k) / 2, (1 + np.exp(-4 * k)) / 2
    spread = (1 + 4 * k**2) * sinh_twice - 2 * k * cosh_twice
    return (8 * sinh_squared / (k * n * spread)) ** (1 / 6)


def split_lobe(mu: ArrayLike, kappa: ArrayLike, n: int) -> tuple[FloatArray, AnyArray]:
    """Split a lobe with axis μ and concentration κ into `n` sharper ones, as wide together.

    Returns their axes (..., n, 3), and their concentration (...).
    """
    sharper = _sharpen_lobe(np.maximum(kappa, 0.1), n)
    return vmf.spread_lobe_points(mu, sharper, n), kernel_bandwidth(sharper, n) ** -2


def estimate_concentration(kappa: ArrayLike, n: int) -> AnyArray:
    """Return the concentration of the kernel density estimate from `n` points of a lobe.

    The lobe itself has the concentration `kappa`, which is larger.
    """
    kappa = np.asarray(kappa, float)
    mean = vmf.spread_lobe_points(np.array([0.0, 0.0, 1.0]), kappa, n).mean(axis=-2)
    # A kernel density estimate is the points convolved with the kernel, so its mean cosine is the
    # product of both mean cosines
    length = np.linalg.norm(mean, axis=-1) * vmf.mean_cosine(kernel_bandwidth(kappa, n) ** -2)
    return vmf.solve_kappa(length)


def _sharpen_lobe(kappa: AnyArray, n: int) -> AnyArray:
    """Return the concentration of a lobe whose kernel density estimate is as wide as a given lobe.

    `kappa` is the concentration of the given lobe. The lobe to find is sharper, because the
    estimate from its `n` points is wider than the lobe itself.
    """
    sharper = kappa * (1 + n ** (-1 / 3))
    for _ in range(10):  # few steps suffice, as `sharper` and its estimate are nearly proportional
        sharper = sharper * kappa / estimate_concentration(sharper, n)
    return sharper
