"""Chooses the numbers with which the search for a texel begins, and restarts badly fitted texels.

All texels begin with a flat surface, a diffuse colour and a highlight, whose width is one of a few
values. Texels that fit badly begin again with these values, or with the numbers of neighbours.
"""

import numpy as np
from scipy.ndimage import median_filter

from brdfkit.core.array_types import FloatArray
from brdfkit.inverse.photographs.capture.observations import Observations
from brdfkit.inverse.photographs.maps.residuals import compute_misfit
from brdfkit.inverse.photographs.maps.texel_parameters import CHANNELS
from brdfkit.inverse.photographs.search.least_squares import fit_each_texel
from brdfkit.inverse.photographs.search.problem import Problem

# Widths of the highlight with which searches start, as shares of the shape parameters' ranges
WIDTHS = 0.08, 0.2, 0.45
START_WEIGHT = 0.1  # weight of every lobe at the start, except for the diffuse one
MATT_SHARE = 0.6  # share of the observations, the darkest ones, that count as free of highlights
DOUBTFUL = 2  # a texel is restarted if its residual is more than this multiple of the noise
SUSPECT = 1.5  # a texel tries its neighbours' numbers if its residual is more than this multiple
RESTART_STEPS = 10
# Shifts (rows, columns) to the eight texels, 1 and 3 texels away, whose numbers a texel tries
OFFSETS = [(way * a, way * b) for way in (1, 3) for a, b in ((0, 1), (1, 0), (0, -1), (-1, 0))]


def make_starting_numbers(problem: Problem, width: float) -> FloatArray:
    """Return the numbers (texels, numbers) of flat, isotropic texels, to begin a search with.

    `width` is the width of the highlight, as a share of the range of the shape parameters.
    """
    parameters, at = problem.parameters, problem.parameters.shape_columns
    low, high = parameters.find_limits()
    x = np.zeros((problem.observed.radiance.shape[1], parameters.count))
    x[:, :CHANNELS] = _estimate_albedos(problem.observed)
    x[:, CHANNELS : at.start] = START_WEIGHT
    x[:, at] = low[at] + width**0.5 * (high[at] - low[at])
    if parameters.pair:
        x[:, at.stop - 2 : at.stop] = 0
    return x


def _estimate_albedos(observed: Observations) -> FloatArray:
    """Return the albedos (n, 3) of texels, as of a matt flat surface, without highlights.

    Only the darkest observations are used. Photometric stereo [Woodham 1980] also gives normals,
    but if all lights are near the camera, as flashes are, these lean by 40°, and the search does
    not find back from there.
    """
    cosine = np.maximum(observed.to_light[..., 2], 0.05)
    ratio = (observed.radiance / np.maximum(observed.irradiance, 1e-30)).mean(axis=2)
    brightness = np.where((observed.weights > 0).all(axis=2), ratio / cosine, np.inf)
    rank = np.argsort(np.argsort(brightness, axis=0), axis=0)
    used = (rank < max(1, round(MATT_SHARE * len(ratio)))) & np.isfinite(brightness)
    lit = observed.irradiance * (cosine * used)[..., None]
    slope = (observed.radiance * lit).sum(axis=0) / np.maximum((lit**2).sum(axis=0), 1e-30)
    return np.pi * np.maximum(slope, 0)


def restart_unexplained_texels(problem: Problem, x: FloatArray, noise: float) -> FloatArray:
    """Search anew the texels whose residuals at `x` are large; return the numbers of all texels.

    `noise` is the variance of relative radiances, with which residuals are compared.
    """
    errors = problem.compute_errors(x)
    wrong = np.flatnonzero(compute_misfit(errors, noise, problem.observed) > DOUBTFUL)
    if not len(wrong):
        return x
    part, x = problem.with_observations(problem.observed.select_texels(wrong)), x.copy()
    for width in WIDTHS:
        trial, error = fit_each_texel(part, make_starting_numbers(part, width), RESTART_STEPS)
        better = error < errors[wrong]
        x[wrong[better]], errors[wrong[better]] = trial[better], error[better]
    return x


def copy_better_neighbours(problem: Problem, x: FloatArray, noise: float) -> FloatArray:
    """Return the numbers `x` (texels, numbers), replaced by neighbours' where these fit better.

    A texel whose residual exceeds the `noise` tries the median of the texels around it and the
    numbers of eight texels nearby, so that good numbers spread, as matches do in
    [Barnes et al. 2009].
    """
    errors = problem.compute_errors(x)
    tried = np.flatnonzero(compute_misfit(errors, noise, problem.observed) > SUSPECT)
    if not len(tried):
        return x
    part = problem.with_observations(problem.observed.select_texels(tried))
    grid, x, errors = x.reshape(*problem.observed.shape, -1), x.copy(), errors[tried]
    median = median_filter(grid, size=(3, 3, 1), mode="nearest")
    for candidate in (median, *(_shift_grid(grid, *offset) for offset in OFFSETS)):
        own = candidate.reshape(x.shape)[tried]
        there = part.compute_errors(own)
        better = there < errors
        x[tried[better]] = own[better]
        errors = np.where(better, there, errors)
        problem.report()
    return x


def _shift_grid(grid: FloatArray, down: int, right: int) -> FloatArray:
    """Return a grid (height, width, count) shifted by whole texels; its edge is repeated."""
    height, width = grid.shape[:2]
    rows = np.clip(np.arange(height) + down, 0, height - 1)
    columns = np.clip(np.arange(width) + right, 0, width - 1)
    return grid[rows][:, columns]
