"""Fits maps of a few large texels first, then maps that are twice as fine, and so on.

A small texel alone may mistake a highlight for its colour; a large part of the sample less so.
"""

from collections.abc import Iterator

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.inverse.photographs.search.least_squares import fit_all_texels, fit_each_texel
from brdfkit.inverse.photographs.search.problem import Problem
from brdfkit.inverse.photographs.search.starts import (
    WIDTHS,
    make_starting_numbers,
    propagate_from_neighbours,
    restart_unexplained,
)

DEFAULT_TAU = 0.1  # the smoothness: the typical difference of neighbours, in units of the numbers
COARSEST_SIDE = 4  # texels along the longer side of the first maps
NOISE_ROUNDS = 5  # the most searches in which the noise is estimated anew
SETTLED = 0.7  # the searches end when the noise is above this share of the previous estimate
SWEEPS = 2  # how often texels take over better numbers of their neighbours


def fit_coarse_to_fine(problem: Problem) -> Iterator[tuple[FloatArray, float, tuple[int, int]]]:
    """Yield the texels' numbers, the variance of the noise and the shape of ever finer maps."""
    finest = problem.observed
    side = 2 ** max(0, int(np.ceil(np.log2(max(finest.shape) / COARSEST_SIDE))))
    level = problem.with_observations(finest.pool_texels(side))
    trials = [fit_each_texel(level, make_starting_numbers(level, width)) for width in WIDTHS]
    errors = np.array([error for _, error in trials])
    best = errors.argmin(axis=0)
    x = np.array([x for x, _ in trials])[best, np.arange(len(best))]
    noise = level.estimate_noise(errors.min(axis=0))
    yield x, noise, level.observed.shape
    while side > 1:
        side //= 2
        coarse, level = level.observed.shape, problem.with_observations(finest.pool_texels(side))
        x = enlarge_map(x, coarse, level.observed.shape, 2)
        x, noise = _fit_with_noise(level, x, noise)
        strength = level.compute_smoothness_weights(
            level.compute_equations(x).hessian, noise, DEFAULT_TAU
        )
        x = fit_with_restarts(level, x, strength, noise)
        noise = level.estimate_noise(level.compute_errors(x))
        yield x, noise, level.observed.shape


def _fit_with_noise(problem: Problem, x: FloatArray, noise: float) -> tuple[FloatArray, float]:
    """Return the texels' numbers and the variance of the noise, after repeated searches.

    `x` and `noise` are from coarser maps, whose residuals are larger than noise. Taken for noise,
    they would make the finer maps too smooth.
    """
    for _ in range(NOISE_ROUNDS):
        hessian = problem.compute_equations(x).hessian
        x = fit_all_texels(
            problem, x, problem.compute_smoothness_weights(hessian, noise, DEFAULT_TAU)
        )
        before, noise = noise, problem.estimate_noise(problem.compute_errors(x))
        if noise > SETTLED * before:
            break
    return x, noise


def enlarge_map(
    x: FloatArray, coarse: tuple[int, int], fine: tuple[int, int], side: int
) -> FloatArray:
    """Return the texels' numbers of `coarse` maps for maps of the shape `fine` (height, width).

    Each texel is repeated `side` × `side` times.
    """
    grid = x.reshape(*coarse, -1).repeat(side, axis=0).repeat(side, axis=1)
    return grid[: fine[0], : fine[1]].reshape(fine[0] * fine[1], -1)


def fit_with_restarts(
    problem: Problem, x: FloatArray, strength: FloatArray, noise: float
) -> FloatArray:
    """Return the numbers of all texels, fitted together, then restarted where they fit badly.

    `x` is (texels, numbers), `strength` (numbers,) the weight of squared differences of neighbours,
    and `noise` the variance of relative radiances.
    """
    x = fit_all_texels(problem, x, strength)
    other = restart_unexplained(problem, x, noise)
    for _ in range(SWEEPS):
        other = propagate_from_neighbours(problem, other)
    if (other != x).any():
        x = fit_all_texels(problem, other, strength)
    return x
