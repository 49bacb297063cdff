"""The methods `warped` and `kde`: one lobe per view, or n sharper lobes in its place.

The thesis warps the lobe of a model's roughness to light. Here a lobe is fitted to what the view
sees, so that any material has one. It is fitted beside a cosine, by the steps of a mixture: light
far from the lobe joins the diffuse part and does not widen the lobe.

`kde` replaces the lobe by a kernel density estimate on the sphere: n of its points, each with a
kernel by García-Portugués's rule of thumb. Kernels blur: the concentration of the sum is only about
κ / (1 + n^(-1/3)). The thesis takes points of the lobe itself; here they are points of a sharper
lobe, chosen so that their estimate is as wide as the lobe.

[Ergun 2015, section 8.6]; [García-Portugués 2013]
"""

from __future__ import annotations

import numpy as np

from brdfkit.core.array_types import AnyArray, ArrayLike, FloatArray
from brdfkit.lighting.spherical_gaussians import von_mises_fisher as vmf
from brdfkit.lighting.spherical_gaussians.one_view import OneView, ViewLobes

STEPS = 50


def warped(grid: list[list[OneView]], lobes: int) -> list[list[ViewLobes]]:
    """Fit one lobe to each view of a `grid`, whatever the number of `lobes`."""
    return [[_split_lobe(one, 1) for one in views] for views in grid]


def kde(grid: list[list[OneView]], lobes: int) -> list[list[ViewLobes]]:
    """Fit one lobe to each view of a `grid`, and split it into sharper `lobes` of equal weight."""
    return [[_split_lobe(one, lobes) for one in views] for views in grid]


def _split_lobe(one: OneView, n: int) -> ViewLobes:
    """Fit the lobe of a view, or `n` lobes in its place; all other light joins the diffuse part."""
    part, _, axis, kappa = fit_lobe(one)
    light = one.energy.sum(axis=0)
    axes, kappas = split(axis, kappa, n) if n > 1 else (axis[None], np.array(kappa))
    weights = np.repeat(part * light[None] / n, n, axis=0)
    return one.diffuse + (1 - part) * light, weights, axes, np.full(n, kappas)


def fit_lobe(one: OneView) -> tuple[float, FloatArray, FloatArray, float]:
    """Fit the likeliest lobe beside a cosine, beginning as narrow as the highest value allows.

    Returns the lobe's part of the light, its share (m,) of each of `one.samples()`, its axis, κ.
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


def bandwidth(kappa: ArrayLike, n: int) -> AnyArray:
    """Return the bandwidth h for `n` samples of a lobe, whose kernels have the κ = 1 / h².

    >>> round(float(bandwidth(50.0, 8)), 6)
    0.100166
    """
    k = np.asarray(kappa, float)
    # Numerator and denominator are multiplied by e^(-2κ)
    sinh_squared = (np.expm1(-2 * k) / 2) ** 2
    sinh_twice, cosh_twice = -np.expm1(-4 * k) / 2, (1 + np.exp(-4 * k)) / 2
    spread = (1 + 4 * k**2) * sinh_twice - 2 * k * cosh_twice
    return (8 * sinh_squared / (k * n * spread)) ** (1 / 6)


def split(mu: ArrayLike, kappa: ArrayLike, n: int) -> tuple[FloatArray, AnyArray]:
    """Return axes (..., n, 3) and κ (...) of `n` lobes that together are as wide as lobe μ, κ."""
    sharper = _sharpen(np.maximum(kappa, 0.1), n)
    return vmf.spread_points(mu, sharper, n), bandwidth(sharper, n) ** -2


def estimate_width(kappa: ArrayLike, n: int) -> AnyArray:
    """Return the concentration of a lobe's estimate by `n` of its points, from its mean."""
    kappa = np.asarray(kappa, float)
    mean = vmf.spread_points(np.array([0.0, 0.0, 1.0]), kappa, n).mean(axis=-2)
    # The mean of a convolution is the product of the two means
    length = np.linalg.norm(mean, axis=-1) * vmf.mean_cosine(bandwidth(kappa, n) ** -2)
    return vmf.solve_kappa(length)


def _sharpen(kappa: AnyArray, n: int) -> AnyArray:
    """Return the concentration whose estimate by `n` points has the concentration `kappa`."""
    sharper = kappa * (1 + n ** (-1 / 3))
    for _ in range(10):  # the estimate's concentration is nearly proportional to it
        sharper = sharper * kappa / estimate_width(sharper, n)
    return sharper
