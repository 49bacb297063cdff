"""Robust least squares: repeated with new weights of the samples, so that outliers count less.

Every pass weighs a sample by its residual after the pass before,

    r = residual / (tune · s · √(1 - h)),   s = MAD / 0.6745,

where h is the sample's leverage and MAD the median of the absolute residuals. [Holland & Welsch
1977]; [Kurt 2007, eqs. 5.14, 5.15]. The constants and the order of the steps are those of MATLAB's
robustfit.

The bisquare ignores noise, but also any peak that the model cannot follow: compare the loss with
that of a fit that is not robust.
"""

from dataclasses import dataclass

import numpy as np

from brdfkit.core.errors import BrdfkitError

PASSES = 50
FAR = 30.0  # exp(-r²) is 0 beyond
TOLERANCE = np.sqrt(np.finfo(float).eps)


def _sine(r):
    return np.where(np.abs(r) < np.pi, np.sinc(r / np.pi), 0)


def _tanh(r):
    return np.tanh(r) / np.where(r == 0, 1, r) + (r == 0)


def _bell(r):
    return np.exp(-(np.minimum(np.abs(r), FAR) ** 2))


def _beyond(limit, inside, outside):
    """A function of |r|: `inside` up to `limit`, `outside` beyond."""

    def function(r):
        r = np.abs(r)
        return np.where(r < limit, inside(np.minimum(r, limit)), outside(r))

    return function


# Name → (weight ω of r, tune: larger is gentler, ρ: the integral of ω r)
WEIGHTS = {
    "andrews": (_sine, 1.339, _beyond(np.pi, lambda r: 1 - np.cos(r), lambda r: 2.0)),
    "bisquare": (
        lambda r: (1 - np.minimum(np.abs(r), 1) ** 2) ** 2,
        4.685,
        _beyond(1, lambda r: (1 - (1 - r**2) ** 3) / 6, lambda r: 1 / 6),
    ),
    "cauchy": (
        lambda r: 1 / (1 + np.minimum(np.abs(r), 1e100) ** 2),
        2.385,
        lambda r: np.log1p(r**2) / 2,
    ),
    "fair": (lambda r: 1 / (1 + np.abs(r)), 1.4, lambda r: np.abs(r) - np.log1p(np.abs(r))),
    "huber": (
        lambda r: 1 / np.maximum(1, np.abs(r)),
        1.345,
        _beyond(1, lambda r: r**2 / 2, lambda r: r - 0.5),
    ),
    "logistic": (_tanh, 1.205, lambda r: np.logaddexp(r, -r) - np.log(2)),
    "talwar": (
        lambda r: (np.abs(r) < 1).astype(float),
        2.795,
        _beyond(1, lambda r: r**2 / 2, lambda r: 0.5),
    ),
    "welsch": (_bell, 2.985, lambda r: (1 - _bell(r)) / 2),
}


@dataclass(frozen=True)
class Reweighted:
    """Where the passes ended: `solution`, the samples' `weights` (n,), the number of `passes`, and
    whether they `converged`."""

    solution: np.ndarray
    weights: np.ndarray
    passes: int
    converged: bool


def sample_weights(residuals, name, rank, least, tune=None):
    """Weights (n,) of samples by their `residuals` (n,), already divided by √(1 - h).

    `name`: in `WEIGHTS`; `rank`: the number of parameters: the smallest rank - 1 residuals are
    nearly zero by construction and are left out of the scale; `least`: the least scale: smaller
    residuals are rounding errors; `tune`: replaces the constant of the weight.
    """
    function, usual, _ = WEIGHTS[name]
    return function(residuals / (scale_of(residuals, rank, least) * (tune or usual)))


def scale_of(residuals, rank, least):
    """The scale s of `residuals` (n,); see `sample_weights`."""
    left = len(residuals) - max(rank - 1, 0)
    # The median of the others is the mean of these one or two in the order of all
    middle = len(residuals) - left + (left - 1) // 2, len(residuals) - left + left // 2
    ordered = np.partition(np.abs(residuals), middle)
    return max((ordered[middle[0]] + ordered[middle[1]]) / 2 / 0.6745, least)


def require_more_samples(samples, rank):
    """Raise `BrdfkitError` unless there are more `samples` than parameters: with as few, the model
    can meet every sample, and no residual tells the scale of the noise."""
    if samples <= rank:
        raise BrdfkitError(
            f"A robust fit needs more samples than parameters; here are {samples} and {rank}: "
            "give more samples, a simpler model, or no robust."
        )


def least_scale(values):
    """The least scale of residuals: 1e-6 of the standard deviation of the fitted `values`."""
    return 1e-6 * np.std(values, ddof=1) or 1.0


def leverages(columns):
    """The leverages h (n,) of `columns` (parameters, n): the diagonal of the projection onto them,
    kept below 1."""
    u, values, _ = np.linalg.svd(columns.T, full_matrices=False)
    u = u[:, values > values.max(initial=0) * len(u) * np.finfo(float).eps]
    return np.minimum((u * u).sum(axis=1), 0.9999)


def robust_least_squares(design, values, name="bisquare", tune=None):
    """The `Reweighted` that fits `design` (n, parameters) · solution to `values` (n,).

    No constant column is added. `converged` is False after 50 passes: the bisquare may alternate
    between solutions. Raises `BrdfkitError` unless there are more values than parameters.

    >>> x = np.arange(5.0)
    >>> robust_least_squares(np.stack([np.ones(5), x], 1), 2 * x).solution.round(6)
    array([-0.,  2.])
    """
    design, values = np.asarray(design, float), np.asarray(values, float)
    require_more_samples(*design.shape)
    lever = np.sqrt(1 - leverages(design.T))
    rank, least = np.linalg.matrix_rank(design), least_scale(values)

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
