"""Fits maps of a few large texels first, and then maps that are twice as fine, and so on.

A small texel alone may mistake a highlight for its colour; a large part of the sample less so.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.inverse.photographs.capture.observations import Observations
from brdfkit.inverse.photographs.maps.texel_parameters import TexelParameters
from brdfkit.inverse.photographs.search.least_squares import (
    Report,
    compute_equations,
    compute_errors,
    fit_all_texels,
    fit_each_texel,
)
from brdfkit.inverse.photographs.search.smoothness import compute_strength, estimate_noise
from brdfkit.inverse.photographs.search.starts import (
    WIDTHS,
    make_start,
    propagate_from_neighbours,
    restart_unexplained,
)

DEFAULT_TAU = 0.1  # the typical difference of neighbours, in their units
COARSEST_SIDE = 4  # texels along the longer side of the first maps
NOISE_ROUNDS = 5  # searches until the estimate of the noise settles, at most
SETTLED = 0.7  # a larger ratio to the noise before ends these searches
SWEEPS = 2  # times that neighbours take over better numbers


def fit_coarse_to_fine(
    parameters: TexelParameters, observed: Observations, report: Report
) -> Iterator[tuple[FloatArray, float, tuple[int, int]]]:
    """Yield the texels' numbers, the variance of the noise and the shape of ever finer maps."""
    side = 2 ** max(0, int(np.ceil(np.log2(max(observed.shape) / COARSEST_SIDE))))
    pooled = observed.pool(side)
    trials = [
        fit_each_texel(parameters, make_start(parameters, pooled, width), pooled, report=report)
        for width in WIDTHS
    ]
    errors = np.array([error for _, error in trials])
    best = errors.argmin(axis=0)
    x = np.array([x for x, _ in trials])[best, np.arange(len(best))]
    noise = estimate_noise(parameters, errors.min(axis=0), pooled)
    yield x, noise, pooled.shape
    while side > 1:
        side //= 2
        coarse, pooled = pooled.shape, observed.pool(side)
        x = enlarge(x, coarse, pooled.shape, 2)
        x, noise = _settle_noise(parameters, x, pooled, noise, report)
        hessian = compute_equations(parameters, x, pooled).hessian
        strength = compute_strength(parameters, hessian, pooled, noise, DEFAULT_TAU)
        x = finish_level(parameters, x, pooled, strength, noise, report)
        noise = estimate_noise(parameters, compute_errors(parameters, x, pooled), pooled)
        yield x, noise, pooled.shape


def _settle_noise(
    parameters: TexelParameters, x: FloatArray, observed: Observations, noise: float, report: Report
) -> tuple[FloatArray, float]:
    """Return the texels' numbers and the variance of the noise, after searches from coarser maps.

    Coarse maps leave more than noise. With that as the noise, finer maps would be too smooth.
    """
    for _ in range(NOISE_ROUNDS):
        hessian = compute_equations(parameters, x, observed).hessian
        strength = compute_strength(parameters, hessian, observed, noise, DEFAULT_TAU)
        x = fit_all_texels(parameters, x, observed, strength, report=report)
        before = noise
        noise = estimate_noise(parameters, compute_errors(parameters, x, observed), observed)
        if noise > SETTLED * before:
            break
    return x, noise


def enlarge(x: FloatArray, coarse: tuple[int, int], fine: tuple[int, int], side: int) -> FloatArray:
    """Return the texels' numbers of maps of the shape `coarse` for maps of the shape `fine`.

    Each texel is repeated `side` × `side` times.
    """
    grid = x.reshape(*coarse, -1).repeat(side, axis=0).repeat(side, axis=1)
    return grid[: fine[0], : fine[1]].reshape(fine[0] * fine[1], -1)


def finish_level(
    parameters: TexelParameters,
    x: FloatArray,
    observed: Observations,
    strength: FloatArray,
    noise: float,
    report: Report,
) -> FloatArray:
    """Return the numbers of texels that are fitted together, after restarts of unexplained ones."""
    x = fit_all_texels(parameters, x, observed, strength, report=report)
    other = restart_unexplained(parameters, x, observed, noise, report)
    for _ in range(SWEEPS):
        other = propagate_from_neighbours(parameters, other, observed, report)
    if (other != x).any():
        x = fit_all_texels(parameters, other, observed, strength, report=report)
    return x
