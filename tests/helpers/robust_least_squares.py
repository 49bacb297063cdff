"""Robust least squares by MATLAB's passes, which a robust fit should end at."""

from dataclasses import dataclass

import numpy as np

from brdfkit.regression.robust.reweighting import (
    WEIGHTS,
    compute_leverages,
    compute_smallest_scale,
    estimate_residual_scale,
    require_more_samples_than_parameters,
)

PASSES = 50
TOLERANCE = np.sqrt(np.finfo(float).eps)


@dataclass(frozen=True)
class Reweighted:
    """The end of the passes; `weights` (n,): of the samples; `passes`: their number."""

    solution: np.ndarray
    weights: np.ndarray
    passes: int
    converged: bool


def sample_weights(residuals, name, rank, least, tune=None):
    """Return weights (n,) of samples by `residuals` (n,), already divided by √(1 - h).

    `name`: in `WEIGHTS`; `rank`, `least`: see `estimate_residual_scale`; `tune`: replaces the
    constant of the weight function.
    """
    function, default, _ = WEIGHTS[name]
    return function(
        residuals / (estimate_residual_scale(residuals, rank, least) * (tune or default))
    )


def robust_least_squares(design, values, name="bisquare", tune=None):
    """Fit `design` (n, parameters) · solution to `values` (n,), and return the `Reweighted`.

    No constant column is added. `converged` is False after 50 passes: the bisquare may alternate
    between solutions.
    """
    design, values = np.asarray(design, float), np.asarray(values, float)
    require_more_samples_than_parameters(*design.shape)
    lever = np.sqrt(1 - compute_leverages(design.T))
    rank, least = np.linalg.matrix_rank(design), compute_smallest_scale(values)

    def solve(weights):
        root = np.sqrt(weights)
        return np.linalg.lstsq(design * root[:, None], values * root, rcond=None)[0]

    solution = solve(np.ones(len(values)))
    for number in range(1, PASSES + 1):
        weights = sample_weights((values - design @ solution) / lever, name, rank, least, tune)
        before, solution = solution, solve(weights)
        # Converged: no entry changes by more than the tolerance times itself
        limit = TOLERANCE * np.maximum(np.abs(solution), np.abs(before))
        if np.all(np.abs(solution - before) <= limit):
            return Reweighted(solution, weights, number, True)
    return Reweighted(solution, weights, number, False)
