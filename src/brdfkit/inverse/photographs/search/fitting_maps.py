"""Fits maps to observations, with the smoothness that best predicts photographs held out."""

from dataclasses import dataclass, replace

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.interrupts import Interrupted
from brdfkit.inverse.photographs.capture.observations import Observations
from brdfkit.inverse.photographs.maps.residuals import UNEXPLAINED, compute_misfit
from brdfkit.inverse.photographs.maps.undetermined import is_observed, is_undetermined
from brdfkit.inverse.photographs.search.coarse_to_fine import (
    DEFAULT_TAU,
    enlarge,
    finish_level,
    fit_coarse_to_fine,
)
from brdfkit.inverse.photographs.search.problem import Equations, Problem

TAUS = 1.0, 0.3, 0.1, 0.03  # typical differences of neighbours, among which held-out lights choose
PATCH_SIDE = 48  # texels: the part of the maps on which they choose
FEWEST_LIGHTS_TO_HOLD_OUT = 8


@dataclass(frozen=True)
class UnfinishedMaps:
    """Maps from a search that may have been interrupted.

    x : the numbers (n, count) of the n texels.
    tau : the typical difference of neighbours, in their units.
    held_out : the relative error of held-out photographs, by each τ that was tried.
    """

    x: FloatArray
    tau: float
    held_out: dict[float, float]


@dataclass(frozen=True)
class FittedMaps(UnfinishedMaps):
    """Maps from a finished search.

    equations : the `Equations` at x.
    noise : the variance of relative radiances.
    strength : the weights (count,) of squared differences of neighbours.
    """

    equations: Equations
    noise: float
    strength: FloatArray


def estimate_steps(lights: int, smoothness: float | None) -> int:
    """Return about how many steps a search for maps takes, for its progress."""
    chooses = smoothness is None and lights >= FEWEST_LIGHTS_TO_HOLD_OUT
    return 250 + 300 * chooses


def fit_maps(problem: Problem, smoothness: float | None = None) -> FittedMaps:
    """Return the maps fitted to the observations; without a `smoothness` (τ), choose it.

    On Ctrl-C `Interrupted` holds the finest `UnfinishedMaps`, if there are any.
    """
    finest = None
    try:
        for finest in fit_coarse_to_fine(problem):
            start, noise, _ = finest
        held_out = {}
        tau = smoothness
        if tau is None:
            tau = DEFAULT_TAU
            if len(problem.observed.radiance) >= FEWEST_LIGHTS_TO_HOLD_OUT:
                held_out = _predict_held_out(problem, noise)
                tau = min(held_out, key=held_out.__getitem__)
        strength = problem.compute_strength(problem.compute_equations(start).hessian, noise, tau)
        x = finish_level(problem, start, strength, noise)
    except KeyboardInterrupt:
        if finest is None:
            raise
        x, _, shape = finest
        raise Interrupted(_enlarge_unfinished(problem.observed.shape, x, shape)) from None
    return FittedMaps(x, tau, held_out, problem.compute_equations(x), noise, strength)


def _predict_held_out(problem: Problem, noise: float) -> dict[float, float]:
    """Return the RMS relative error of held-out photographs for each τ, on a patch of the maps."""
    patch = _select_patch(problem.observed)
    lights = np.arange(len(patch.radiance))
    held_out = lights[1 :: max(2, len(lights) // 3)]
    fitted = problem.on(patch.select_lights(np.setdiff1d(lights, held_out)))
    hidden = problem.on(patch.select_lights(held_out))
    *_, (start, _, _) = fit_coarse_to_fine(fitted)
    hessian, errors = fitted.compute_equations(start).hessian, {}
    for tau in TAUS:
        x = finish_level(fitted, start, fitted.compute_strength(hessian, noise, tau), noise)
        error = hidden.compute_errors(x).sum()
        errors[tau] = float(np.sqrt(error / max(1, (hidden.observed.weights > 0).sum())))
    return errors


def _select_patch(observed: Observations) -> Observations:
    """Return the observations of a patch in the middle."""
    height, width = observed.shape
    rows, columns = min(height, PATCH_SIDE), min(width, PATCH_SIDE)
    top, left = (height - rows) // 2, (width - columns) // 2
    texel = np.arange(height * width).reshape(height, width)
    patch = observed.select_texels(texel[top : top + rows, left : left + columns].ravel())
    return replace(patch, shape=(rows, columns))


def _enlarge_unfinished(
    shape: tuple[int, int], x: FloatArray, coarse: tuple[int, int]
) -> UnfinishedMaps:
    """Return coarser maps as they are, enlarged to `shape`."""
    side = 1  # a power of 2, as in `fit_coarse_to_fine`
    while side * coarse[0] < shape[0] or side * coarse[1] < shape[1]:
        side *= 2
    return UnfinishedMaps(enlarge(x, coarse, shape, side), DEFAULT_TAU, {})


def compute_standard_errors(problem: Problem, fitted: FittedMaps) -> FloatArray:
    """Return the standard errors (n, count) of all numbers, with the neighbours taken as known.

    Those of unexplained texels are scaled by their residuals. Where the photographs leave numbers
    of a texel undetermined, they do so in the neighbours, too; there each number has half of its
    range, or its unit, as an error instead.
    """
    noise, own = fitted.noise, fitted.equations.hessian
    ranges, (low, high) = problem.find_units(own), problem.parameters.limits()
    is_limited = np.isfinite(high - low)
    ranges[is_limited] = (high - low)[is_limited] / 2
    prior = np.diag(noise / ranges**2)
    together = own + 4 * np.diag(fitted.strength * is_observed(own)) + prior
    matrix = np.where(is_undetermined(own)[:, None, None], own + prior, together)
    variance = np.diagonal(np.linalg.inv(matrix), axis1=1, axis2=2)
    misfit = compute_misfit(fitted.equations.error, noise, problem.observed)
    variance = np.maximum(variance, 0) * noise
    return np.sqrt(variance) * np.where(misfit > UNEXPLAINED, misfit, 1)[:, None]
