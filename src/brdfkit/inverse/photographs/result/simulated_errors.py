"""Estimates standard errors of maps by a simulation.

Photographs of the fitted maps are rendered, with noise like that of the real ones, and fitted in
the same way. The distance of the new maps from the fitted ones shows how far the fitted ones may be
from the truth. The noise of a pixel is its residual with a random sign: the wild bootstrap
[Wu 1986]. So the errors include the effects of the renderer, the smoothness and the blur of pixels,
which the equations of single texels ignore.
"""

from dataclasses import replace

import numpy as np
from scipy.ndimage import uniform_filter

from brdfkit.core.array_types import AnyArray, FloatArray
from brdfkit.inverse.photographs.capture.capture import Capture
from brdfkit.inverse.photographs.capture.observations import sample_at_texels
from brdfkit.inverse.photographs.search.fitting_maps import compute_standard_errors
from brdfkit.inverse.photographs.search.least_squares import fit_all_texels
from brdfkit.inverse.photographs.search.problem import Problem
from brdfkit.inverse.photographs.search.through_renderer import (
    STEPS_PER_ROUND,
    RenderedMaps,
    correct_maps,
    render_maps,
)

AVERAGED_SIDE = 9  # side [texels] of the square over which simulated errors are averaged
# Largest ratio that counts, of the error in the simulation to the error computed from the equations
# of a texel
LARGEST_ERROR_RATIO = 5.0
# Lower limit of the share of the noise's variance that is left in the residuals, as a fit follows a
# part of the noise
FEWEST_FREE = 0.3


def simulate_standard_errors(
    problem: Problem, rendered: RenderedMaps, rounds: int, capture: Capture
) -> FloatArray:
    """Return the standard errors (texels, numbers) of the searched numbers of all texels.

    An error is first computed from the equations of its texel alone, then multiplied by a factor:
    the RMS ratio of simulated errors to errors from the equations, over the texels around it.
    `rounds` is how often the renderer corrected the maps.
    """
    fitted, observed = rendered.fitted, problem.observed
    signs = np.random.default_rng(0).choice([-1.0, 1.0], capture.pictures.shape[:3])[..., None]
    residuals = capture.pictures - rendered.pictures
    noise = residuals * signs * _find_noise_factor(problem, capture)
    pictures = np.where(capture.counted, rendered.pictures + noise, rendered.pictures)
    simulated = replace(capture, pictures=pictures, lost=capture.excluded)
    radiance = sample_at_texels(simulated, pictures, observed.shape)
    target = problem.with_observations(replace(observed, radiance=radiance))
    x = fit_all_texels(target, fitted.x.copy(), fitted.strength, STEPS_PER_ROUND)
    again = replace(fitted, x=x, equations=target.compute_equations(x))
    for number in range(rounds):
        start = render_maps(problem, again, simulated)
        again = correct_maps(problem, start, number == 0, simulated)
    errors = compute_standard_errors(problem, fitted)
    ratio = np.abs(again.x - fitted.x) / np.maximum(errors, 1e-300)
    ratio = np.minimum(ratio, LARGEST_ERROR_RATIO)
    shown = (observed.weights > 0).any(axis=(0, 2)).astype(float)
    total = _sum_over_neighbours(ratio**2 * shown[:, None], observed.shape)
    mean = total / np.maximum(_sum_over_neighbours(shown, observed.shape), 1)
    return errors * np.sqrt(np.maximum(1, mean))


def _sum_over_neighbours(values: AnyArray, shape: tuple[int, int]) -> FloatArray:
    """Return for each texel the sum over the 9 × 9 texels around it.

    `values` (texels, numbers) or (n,) belong to the n texels of a map of `shape` (height, width).
    """
    grid = values.reshape(*shape, -1)
    size = (AVERAGED_SIDE, AVERAGED_SIDE, 0)
    mean: FloatArray = uniform_filter(grid, size=size, mode="constant")
    return AVERAGED_SIDE**2 * mean.reshape(len(values), -1)


def _find_noise_factor(problem: Problem, capture: Capture) -> float:
    """Return the factor by which the photographs' noise exceeds the residuals of the maps.

    A fit follows the noise of about as many values as it has numbers, so that residuals are smaller
    than noise.
    """
    shown = int(np.any(problem.observed.weights > 0, axis=(0, 2)).sum())
    photographed = max(1, int(capture.counted.sum()))
    free = 1 - problem.parameters.count * shown / photographed
    return float(1 / np.sqrt(max(free, FEWEST_FREE)))
