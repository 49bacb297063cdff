"""Fits maps of a few large texels first, then maps that are twice as fine, and so on.

A small texel sees few directions of light and view, and may take a highlight for its colour. A
large texel sees more directions, and its numbers are a good start for the small texels within it.
"""

from collections.abc import Iterator

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.inverse.photographs.search.least_squares import fit_all_texels, fit_each_texel
from brdfkit.inverse.photographs.search.problem import Problem
from brdfkit.inverse.photographs.search.starts import (
    WIDTHS,
    copy_better_neighbours,
    make_starting_numbers,
    restart_unexplained_texels,
)

# Smoothness τ if none is given: the typical difference of neighbouring texels, in units of the
# searched numbers
DEFAULT_TAU = 0.1
COARSEST_SIDE = 4  # number of texels along the longer side of the first maps
NOISE_ROUNDS = 5  # largest number of searches, after each of which the noise is estimated again
# No further search is made if the new estimate of the noise exceeds this share of the previous one
SETTLED = 0.7
# How often badly fitted texels try their neighbours' numbers, and keep those that fit better
SWEEPS = 2


def fit_coarse_to_fine(problem: Problem) -> Iterator[tuple[FloatArray, float, tuple[int, int]]]:
    """Yield for ever finer maps the searched numbers, the variance of the noise and the shape."""
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
        coarse = level.observed.shape
        level = problem.with_observations(finest.pool_texels(side)) if side > 1 else problem
        x = enlarge_map(x, coarse, level.observed.shape, 2)
        x, noise = _fit_and_estimate_noise(level, x, noise)
        strength = level.compute_smoothness_weights(
            level.compute_equations(x).hessian, noise, DEFAULT_TAU
        )
        x = fit_with_restarts(level, x, strength, noise)
        noise = level.estimate_noise(level.compute_errors(x))
        yield x, noise, level.observed.shape


def _fit_and_estimate_noise(
    problem: Problem, x: FloatArray, noise: float
) -> tuple[FloatArray, float]:
    """Search repeatedly; return the numbers of the texels, and the variance of the noise.

    The search begins with `x` and `noise` of the coarser maps. Their residuals contain details that
    only finer maps explain, so this `noise` is too large and would make the maps too smooth. Each
    search therefore estimates it again.
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
    """Return the numbers `x` of texels in larger maps, where each texel is repeated.

    `coarse` and `fine` are the shapes (height, width) of the maps before and after. A texel becomes
    `side` × `side` texels.
    """
    grid = x.reshape(*coarse, -1).repeat(side, axis=0).repeat(side, axis=1)
    return grid[: fine[0], : fine[1]].reshape(fine[0] * fine[1], -1)


def fit_with_restarts(
    problem: Problem, x: FloatArray, strength: FloatArray, noise: float
) -> FloatArray:
    """Fit the numbers of all texels together, and again from other starts where they fit badly.

    The search begins at `x` (texels, numbers). `strength` (numbers,) is the weight of squared
    differences of neighbours, and `noise` the variance of relative radiances.
    """
    x = fit_all_texels(problem, x, strength)
    other = restart_unexplained_texels(problem, x, noise)
    for _ in range(SWEEPS):
        other = copy_better_neighbours(problem, other, noise)
    if (other != x).any():
        x = fit_all_texels(problem, other, strength)
    return x
