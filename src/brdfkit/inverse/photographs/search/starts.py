"""Chooses where the search for a texel begins, and restarts texels in a poor local minimum.

All texels begin matt and flat, with a few widths of the highlight. Restarted texels begin there
again, or with the numbers of their neighbours.
"""

import numpy as np
from scipy.ndimage import median_filter

from brdfkit.core.array_types import FloatArray
from brdfkit.inverse.photographs.capture.observations import Observations
from brdfkit.inverse.photographs.maps.residuals import compute_misfit
from brdfkit.inverse.photographs.maps.texel_parameters import CHANNELS
from brdfkit.inverse.photographs.search.least_squares import fit_each_texel
from brdfkit.inverse.photographs.search.problem import Problem

WIDTHS = 0.08, 0.2, 0.45  # highlights to begin with, as shares of the shape parameters' range
START_WEIGHT = 0.1  # every lobe begins with it, except for the first, which is diffuse
MATT_SHARE = 0.6  # this share of the observations, the darker ones, counts as without highlights
DOUBTFUL = 2  # times the noise, from which a texel is restarted
RESTART_STEPS = 10
OFFSETS = [(way * a, way * b) for way in (1, 3) for a, b in ((0, 1), (1, 0), (0, -1), (-1, 0))]


def make_start(problem: Problem, width: float) -> FloatArray:
    """Return the numbers (n, count) with which n texels begin, flat and isotropic.

    `width` is the width of the highlight, as a share of the range of the shape parameters.
    """
    parameters, at = problem.parameters, problem.parameters.shape_columns
    low, high = parameters.limits()
    x = np.zeros((problem.observed.radiance.shape[1], parameters.count))
    x[:, :CHANNELS] = _estimate_albedos(problem.observed)
    x[:, CHANNELS : at.start] = START_WEIGHT
    x[:, at] = low[at] + width**0.5 * (high[at] - low[at])
    if parameters.pair:
        x[:, at.stop - 2 : at.stop] = 0
    return x


def _estimate_albedos(observed: Observations) -> FloatArray:
    """Return the albedos (n, 3) of a matt and flat surface, from the darker observations.

    Normals from photometric stereo [Woodham 1980] are no better a start: with all lights near the
    camera, as flashes are, they lean by 40°, from where the search does not return.
    """
    cosine = np.maximum(observed.to_light[..., 2], 0.05)
    ratio = (observed.radiance / np.maximum(observed.irradiance, 1e-30)).mean(axis=2)
    brightness = np.where((observed.weights > 0).all(axis=2), ratio / cosine, np.inf)
    rank = np.argsort(np.argsort(brightness, axis=0), axis=0)
    used = (rank < max(1, round(MATT_SHARE * len(ratio)))) & np.isfinite(brightness)
    lit = observed.irradiance * (cosine * used)[..., None]
    slope = (observed.radiance * lit).sum(axis=0) / np.maximum((lit**2).sum(axis=0), 1e-30)
    return np.pi * np.maximum(slope, 0)


def restart_unexplained(problem: Problem, x: FloatArray, noise: float) -> FloatArray:
    """Return the texels' numbers `x` (n, count), searched anew where residuals are large."""
    errors = problem.compute_errors(x)
    wrong = np.flatnonzero(compute_misfit(errors, noise, problem.observed) > DOUBTFUL)
    if not len(wrong):
        return x
    part, x = problem.on(problem.observed.select_texels(wrong)), x.copy()
    for width in WIDTHS:
        trial, error = fit_each_texel(part, make_start(part, width), RESTART_STEPS)
        better = error < errors[wrong]
        x[wrong[better]], errors[wrong[better]] = trial[better], error[better]
    return x


def propagate_from_neighbours(problem: Problem, x: FloatArray) -> FloatArray:
    """Return the texels' numbers `x` (n, count), replaced where other numbers fit better.

    The candidates are the median around the texel and the numbers of texels nearby, so that good
    numbers spread as matches do in [Barnes et al. 2009].
    """
    grid = x.reshape(*problem.observed.shape, -1)
    errors = problem.compute_errors(x)
    median = median_filter(grid, size=(3, 3, 1), mode="nearest")
    for candidate in (median, *(_shift(grid, *offset) for offset in OFFSETS)):
        candidate = candidate.reshape(x.shape)
        there = problem.compute_errors(candidate)
        better = there < errors
        x, errors = np.where(better[:, None], candidate, x), np.where(better, there, errors)
        problem.report()
    return x


def _shift(grid: FloatArray, down: int, right: int) -> FloatArray:
    """Return the grid (height, width, count) shifted by texels; the edge is repeated."""
    height, width = grid.shape[:2]
    rows = np.clip(np.arange(height) + down, 0, height - 1)
    columns = np.clip(np.arange(width) + right, 0, width - 1)
    return grid[rows][:, columns]
