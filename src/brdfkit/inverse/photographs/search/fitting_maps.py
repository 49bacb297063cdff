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
    enlarge_map,
    fit_coarse_to_fine,
    fit_with_restarts,
)
from brdfkit.inverse.photographs.search.problem import Equations, Problem

# Values that are tried for the smoothness τ, the typical difference of neighbouring texels
TAUS = 1.0, 0.3, 0.1, 0.03
PATCH_SIDE = 48  # number of texels along a side of the patch on which values of τ are tried
FEWEST_LIGHTS_TO_HOLD_OUT = 8


@dataclass(frozen=True)
class UnfinishedMaps:
    """The result of a search for maps that may have been interrupted.

    x : the searched numbers (texels, numbers); `TexelParameters` describes the columns.
    tau : the smoothness τ, the typical difference of neighbouring texels in units of their numbers.
    held_out : the relative error of held-out photographs for each τ that was tried.
    """

    x: FloatArray
    tau: float
    held_out: dict[float, float]


@dataclass(frozen=True)
class FittedMaps(UnfinishedMaps):
    """The result of a finished search for maps, and what is needed for their standard errors.

    equations : the Gauss-Newton equations of the texels at `x`.
    noise : the variance of relative radiances.
    strength : the weights (numbers,) of squared differences of neighbours.
    """

    equations: Equations
    noise: float
    strength: FloatArray


def estimate_search_steps(lights: int, smoothness: float | None) -> int:
    """Return the approximate number of steps of a search for maps, for its progress bar."""
    chooses = smoothness is None and lights >= FEWEST_LIGHTS_TO_HOLD_OUT
    return 250 + 300 * chooses


def fit_maps(problem: Problem, smoothness: float | None = None) -> FittedMaps:
    """Return the maps fitted to the observations, with a given or the best smoothness τ.

    Without a `smoothness`, τ is chosen so that photographs held out are predicted best. On Ctrl-C
    `Interrupted` holds the finest `UnfinishedMaps`, if there are any.
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
                held_out = _measure_held_out_errors(problem, noise)
                tau = min(held_out, key=held_out.__getitem__)
        strength = problem.compute_smoothness_weights(
            problem.compute_equations(start).hessian, noise, tau
        )
        x = fit_with_restarts(problem, start, strength, noise)
    except KeyboardInterrupt:
        if finest is None:
            raise
        x, _, shape = finest
        raise Interrupted(_enlarge_unfinished_maps(problem.observed.shape, x, shape)) from None
    return FittedMaps(x, tau, held_out, problem.compute_equations(x), noise, strength)


def _measure_held_out_errors(problem: Problem, noise: float) -> dict[float, float]:
    """Return for each smoothness τ how badly maps predict photographs that were held out.

    Three or four photographs are held out, and a patch in the middle of the maps is fitted to the
    others. The error is the RMS relative error of the radiances that the patch predicts for the
    photographs held out. τ is the typical difference of neighbouring texels; `noise` is the
    variance of relative radiances.
    """
    patch = _select_middle_patch(problem.observed)
    lights = np.arange(len(patch.radiance))
    held_out = lights[1 :: max(2, len(lights) // 3)]
    fitted = problem.with_observations(patch.select_lights(np.setdiff1d(lights, held_out)))
    hidden = problem.with_observations(patch.select_lights(held_out))
    *_, (start, _, _) = fit_coarse_to_fine(fitted)
    hessian, errors = fitted.compute_equations(start).hessian, {}
    for tau in TAUS:
        x = fit_with_restarts(
            fitted, start, fitted.compute_smoothness_weights(hessian, noise, tau), noise
        )
        error = hidden.compute_errors(x).sum()
        errors[tau] = float(np.sqrt(error / max(1, (hidden.observed.weights > 0).sum())))
    return errors


def _select_middle_patch(observed: Observations) -> Observations:
    """Return the observations of a square patch in the middle of the maps."""
    height, width = observed.shape
    rows, columns = min(height, PATCH_SIDE), min(width, PATCH_SIDE)
    top, left = (height - rows) // 2, (width - columns) // 2
    texel = np.arange(height * width).reshape(height, width)
    patch = observed.select_texels(texel[top : top + rows, left : left + columns].ravel())
    return replace(patch, shape=(rows, columns))


def _enlarge_unfinished_maps(
    shape: tuple[int, int], x: FloatArray, coarse: tuple[int, int]
) -> UnfinishedMaps:
    """Return the maps of an interrupted search enlarged to `shape` (height, width).

    `x` (texels, numbers) holds their searched numbers, `coarse` is their own height and width.
    """
    side = 1  # grows to the power of 2 by which `fit_coarse_to_fine` reduced the maps
    while side * coarse[0] < shape[0] or side * coarse[1] < shape[1]:
        side *= 2
    return UnfinishedMaps(enlarge_map(x, coarse, shape, side), DEFAULT_TAU, {})


def compute_standard_errors(problem: Problem, fitted: FittedMaps) -> FloatArray:
    """Return the standard errors (texels, numbers) of the searched numbers.

    Each error assumes that the numbers of the neighbouring texels are known. If the photographs do
    not determine a texel, they hardly determine its neighbours either: then only the range or the
    unit of a number limits its error. Other errors are larger where residuals exceed the noise.
    """
    noise, own = fitted.noise, fitted.equations.hessian
    ranges, (low, high) = problem.find_number_units(own), problem.parameters.find_limits()
    is_limited = np.isfinite(high - low)
    ranges[is_limited] = (high - low)[is_limited] / 2
    prior = np.diag(noise / ranges**2)
    together = own + 4 * np.diag(fitted.strength * is_observed(own)) + prior
    is_open = is_undetermined(own)
    matrix = np.where(is_open[:, None, None], own + prior, together)
    variance = np.diagonal(np.linalg.inv(matrix), axis1=1, axis2=2)
    misfit = compute_misfit(fitted.equations.error, noise, problem.observed)
    variance = np.maximum(variance, 0) * noise
    return np.sqrt(variance) * np.where((misfit > UNEXPLAINED) & ~is_open, misfit, 1)[:, None]
