"""Estimates standard errors of maps by a simulation.

Photographs of the fitted maps, with noise like that of the real ones, are fitted in the same way.
How far the new maps are from the fitted ones shows how far these may be from the truth. The noise
is what is left of the photographs, each pixel's residual with a random sign: the wild bootstrap
[Wu 1986]. So the errors include the effects of the renderer, the smoothness and the blur of pixels,
which the equations of single texels ignore.
"""

from dataclasses import replace

import numpy as np
from scipy.ndimage import uniform_filter

from brdfkit.core.array_types import AnyArray, FloatArray
from brdfkit.inverse.photographs.capture.capture import Capture
from brdfkit.inverse.photographs.capture.observations import sample_pictures
from brdfkit.inverse.photographs.search.fitting_maps import compute_standard_errors
from brdfkit.inverse.photographs.search.least_squares import fit_all_texels
from brdfkit.inverse.photographs.search.problem import Problem
from brdfkit.inverse.photographs.search.through_renderer import (
    STEPS_PER_ROUND,
    RenderedMaps,
    correct_maps,
    render_maps,
)

AVERAGED_SIDE = 9  # texels: simulated errors are averaged over this square
LARGEST_ERROR_RATIO = 5.0  # a simulated error over that of the equations: larger ones are clipped
FEWEST_FREE = 0.3  # at least this share of the photographs' noise is not fitted by the maps


def simulate_errors(
    problem: Problem, rendered: RenderedMaps, rounds: int, capture: Capture
) -> FloatArray:
    """Return the standard errors (n, count) of the numbers of maps.

    They are those of the equations of each texel, scaled by what the simulation shows around it.
    `rounds` is the number of corrections that led to the maps.
    """
    fitted, observed = rendered.fitted, problem.observed
    signs = np.random.default_rng(0).choice([-1.0, 1.0], capture.pictures.shape[:3])[..., None]
    residuals = capture.pictures - rendered.pictures
    noise = residuals * signs * _find_noise_factor(problem, capture)
    pictures = np.where(capture.counted, rendered.pictures + noise, rendered.pictures)
    simulated = replace(capture, pictures=pictures, lost=capture.excluded)
    radiance = sample_pictures(simulated, pictures, observed.shape)
    target = problem.on(replace(observed, radiance=radiance))
    x = fit_all_texels(target, fitted.x.copy(), fitted.strength, STEPS_PER_ROUND)
    again = replace(fitted, x=x, equations=target.compute_equations(x))
    for number in range(rounds):
        start = render_maps(problem, again, simulated)
        again = correct_maps(problem, start, number == 0, simulated)
    errors = compute_standard_errors(problem, fitted)
    ratio = np.abs(again.x - fitted.x) / np.maximum(errors, 1e-300)
    ratio = np.minimum(ratio, LARGEST_ERROR_RATIO)
    shown = (observed.weights > 0).any(axis=(0, 2)).astype(float)
    total = _sum_around(ratio**2 * shown[:, None], observed.shape)
    mean = total / np.maximum(_sum_around(shown, observed.shape), 1)
    return errors * np.sqrt(np.maximum(1, mean))


def _sum_around(values: AnyArray, shape: tuple[int, int]) -> FloatArray:
    """Return the sums (n, count) over the texels around each, of values (n, count) or (n,)."""
    grid = values.reshape(*shape, -1)
    size = (AVERAGED_SIDE, AVERAGED_SIDE, 0)
    mean: FloatArray = uniform_filter(grid, size=size, mode="constant")
    return AVERAGED_SIDE**2 * mean.reshape(len(values), -1)


def _find_noise_factor(problem: Problem, capture: Capture) -> float:
    """Return the ratio of the noise to the residuals, which the fit makes smaller."""
    shown = int(np.any(problem.observed.weights > 0, axis=(0, 2)).sum())
    photographed = max(1, int(capture.counted.sum()))
    free = 1 - problem.parameters.count * shown / photographed
    return float(1 / np.sqrt(max(free, FEWEST_FREE)))
