"""Estimates standard errors of maps by a simulation.

Photographs of the fitted maps are rendered, with noise like that of the real ones, and fitted in
the same way. The distance of the new maps from the fitted ones shows how far the fitted ones may be
from the truth. The noise of a pixel is its residual with a random sign: the wild bootstrap
[Wu 1986]. So the errors include the effects of the renderer, the smoothness and the blur of pixels,
which the equations of single texels ignore.

Two things are missing from such a simulation, and are added:

- The fit follows a part of the noise, so that residuals are smaller than noise. The residuals of
  the simulated photographs show by how much, because their noise is known.
- The fitted maps have lost details to the smoothness, so that the simulation cannot lose them
  again. Therefore both the real and the simulated photographs are also fitted with maps that may be
  `ROUGHER` times as rough. With the smoothness τ, the fit x(τ) of the real photographs and x*(τ) of
  the simulated ones, the mean square of the lost details is

      (1 - 1 / ROUGHER²)⁻² (⟨|x(τ) - x(ROUGHER τ)|²⟩ - ⟨|x*(τ) - x*(ROUGHER τ)|²⟩),

  as the smoothness removes details in proportion to 1 / τ² [Richardson 1911].
"""

from dataclasses import replace

import numpy as np
from scipy.ndimage import uniform_filter

from brdfkit.core.array_types import AnyArray, BoolArray, FloatArray
from brdfkit.inverse.photographs.capture.capture import Capture
from brdfkit.inverse.photographs.capture.observations import sample_at_texels
from brdfkit.inverse.photographs.maps.undetermined import is_undetermined
from brdfkit.inverse.photographs.search.fitting_maps import FittedMaps, compute_standard_errors
from brdfkit.inverse.photographs.search.least_squares import fit_all_texels
from brdfkit.inverse.photographs.search.problem import Problem
from brdfkit.inverse.photographs.search.through_renderer import (
    STEPS_PER_ROUND,
    RenderedMaps,
    correct_maps,
    render_maps,
)

# Sides [texels] of the squares over which squared errors and lost details are averaged; the latter
# are a small difference of large numbers
ERROR_SIDE, DETAIL_SIDE = 9, 33
ROUGHER = 2.0  # how much rougher the maps may be that show which details are lost
# Largest ratio that counts, of the error in the simulation to the error computed from the equations
# of a texel
LARGEST_ERROR_RATIO = 5.0
# Lower limit of the simulated squared errors, after the lost details of the fitted and of the new
# maps were compared
SMALLEST_REMAINDER = 0.5
SMALLEST_SHARE = 0.5  # lower limit of the share of the noise that is left in the residuals


def simulate_standard_errors(
    problem: Problem, rendered: RenderedMaps, rounds: int, capture: Capture
) -> FloatArray:
    """Return the standard errors (texels, numbers) of the searched numbers of all texels.

    An error is first computed from the equations of its texel alone, then multiplied by a factor:
    the RMS ratio of simulated errors to errors from the equations, over the texels around it.
    `rounds` is how often the renderer corrected the maps.
    """
    fitted = rendered.fitted
    target, simulated = _simulate_photographs(problem, rendered, capture)
    rougher = replace(fitted, tau=ROUGHER * fitted.tau, strength=fitted.strength / ROUGHER**2)
    again = _fit_again(target, fitted, rounds, simulated)
    share = _measure_share_of_noise(
        simulated, rendered.pictures, render_maps(target, again, simulated).pictures
    )
    lost = fitted.x - _fit_again(problem, rougher, rounds, capture).x
    lost_again = (again.x - _fit_again(target, rougher, rounds, simulated).x) / share

    errors = compute_standard_errors(problem, fitted)
    shown: BoolArray = np.any(problem.observed.weights > 0, axis=(0, 2))
    is_open = is_undetermined(fitted.equations.hessian)

    def average(differences: FloatArray, side: int, counted: BoolArray) -> FloatArray:
        """Return the mean squared ratio of differences to errors, over the texels around each."""
        ratio = np.minimum(np.abs(differences) / np.maximum(errors, 1e-300), LARGEST_ERROR_RATIO)
        return _average_over_neighbours(ratio**2, counted, problem.observed.shape, side)

    off, determined = (again.x - fitted.x) / share, shown & ~is_open
    square = average(off, ERROR_SIDE, determined)
    details = average(lost, DETAIL_SIDE, determined) - average(lost_again, DETAIL_SIDE, determined)
    total = square + details / (1 - 1 / ROUGHER**2) ** 2
    # Chance may make the lost details negative
    square = np.maximum(total, SMALLEST_REMAINDER * square)
    # What the photographs do not determine stays as uncertain as its range
    at_least_range = np.maximum(average(off, ERROR_SIDE, shown), 1)
    return errors * np.sqrt(np.where(is_open[:, None], at_least_range, square))


def _simulate_photographs(
    problem: Problem, rendered: RenderedMaps, capture: Capture
) -> tuple[Problem, Capture]:
    """Return photographs of the fitted maps with noise like that of the real ones, to be fitted."""
    signs = np.random.default_rng(0).choice([-1.0, 1.0], capture.pictures.shape[:3])[..., None]
    noise = (capture.pictures - rendered.pictures) * signs
    pictures = np.where(capture.counted, rendered.pictures + noise, rendered.pictures)
    simulated = replace(capture, pictures=pictures, lost=capture.excluded)
    radiance = sample_at_texels(simulated, pictures, problem.observed.shape)
    return problem.with_radiances(radiance), simulated


def _fit_again(problem: Problem, start: FittedMaps, rounds: int, capture: Capture) -> FittedMaps:
    """Return maps fitted to the photographs in the same way; the search begins at `start`."""
    x = fit_all_texels(problem, start.x.copy(), start.strength, STEPS_PER_ROUND)
    again = replace(start, x=x, equations=problem.compute_equations(x))
    for number in range(rounds):
        rendered = render_maps(problem, again, capture)
        again = correct_maps(problem, rendered, number == 0, capture)
    return again


def _measure_share_of_noise(
    simulated: Capture, without_noise: FloatArray, rendered: FloatArray
) -> float:
    """Return the share of the noise of simulated photographs that is left in their residuals.

    `without_noise` are these photographs without noise, and `rendered` are pictures of the maps
    that were fitted to them, both (lights, height, width, 3).
    """
    counted = simulated.counted
    noise = np.median(np.abs(simulated.pictures - without_noise)[counted])
    left = np.median(np.abs(simulated.pictures - rendered)[counted])
    return float(np.clip(left / max(noise, 1e-300), SMALLEST_SHARE, 1))


def _average_over_neighbours(
    values: AnyArray, counted: BoolArray, shape: tuple[int, int], side: int
) -> FloatArray:
    """Return for each texel the mean over the texels that count in a square around it.

    `values` (texels, numbers) belong to the texels of a map of `shape` (height, width), and
    `counted` (texels,) says which count. The square has `side` texels along a side.
    """
    share = counted.astype(float)

    def average(numbers: AnyArray) -> FloatArray:
        """Return the mean over the squares, where texels beyond the maps count as 0."""
        grid = numbers.reshape(*shape, -1)
        mean: FloatArray = uniform_filter(grid, size=(side, side, 0), mode="constant")
        return mean.reshape(len(numbers), -1)

    return average(values * share[:, None]) / np.maximum(average(share), 0.5 / side**2)
