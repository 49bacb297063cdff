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

from brdfkit.errors import BrdfkitError
from brdfkit.fitting.search import slsqp

PASSES = 50
TOLERANCE = np.sqrt(np.finfo(float).eps)


def _sine(r):
    return np.where(np.abs(r) < np.pi, np.sinc(r / np.pi), 0)


def _tanh(r):
    return np.tanh(r) / np.where(r == 0, 1, r) + (r == 0)


# Name → (weight of r, tune: larger is gentler)
WEIGHTS = {
    "andrews": (_sine, 1.339),
    "bisquare": (lambda r: np.where(np.abs(r) < 1, (1 - r**2) ** 2, 0), 4.685),
    "cauchy": (lambda r: 1 / (1 + r**2), 2.385),
    "fair": (lambda r: 1 / (1 + np.abs(r)), 1.4),
    "huber": (lambda r: 1 / np.maximum(1, np.abs(r)), 1.345),
    "logistic": (_tanh, 1.205),
    "talwar": (lambda r: (np.abs(r) < 1).astype(float), 2.795),
    "welsch": (lambda r: np.exp(-(r**2)), 2.985),
}


@dataclass(frozen=True)
class Reweighted:
    """Where the passes ended: `solution`, the samples' `weights` (n,), the number of `passes`, and
    whether they `converged`."""

    solution: np.ndarray
    weights: np.ndarray
    passes: int
    converged: bool


def reweight(solve, weigh, start, tolerance=TOLERANCE):
    """Repeat solution = `solve(weigh(solution), solution)` from `start` until it converges.

    A solution is an array. It has converged when no entry changes by more than `tolerance` times
    itself.
    """
    solution = start
    for number in range(1, PASSES + 1):
        weights = weigh(solution)
        before, solution = solution, solve(weights, solution)
        limit = tolerance * np.maximum(np.abs(solution), np.abs(before))
        if np.all(np.abs(solution - before) <= limit):
            return Reweighted(solution, weights, number, True)
    return Reweighted(solution, weights, number, False)


def sample_weights(residuals, name, rank, least, tune=None):
    """Weights (n,) of samples by their `residuals` (n,), already divided by √(1 - h).

    `name`: in `WEIGHTS`; `rank`: the number of parameters: the smallest rank - 1 residuals are
    nearly zero by construction and are left out of the scale; `least`: the least scale: smaller
    residuals are rounding errors; `tune`: replaces the constant of the weight.
    """
    function, usual = WEIGHTS[name]
    ordered = np.sort(np.abs(residuals))
    scale = max(np.median(ordered[max(rank - 1, 0) :]) / 0.6745, least)
    return function(residuals / (scale * (tune or usual)))


def _require_more_samples(samples, rank):
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
    gram = columns @ columns.T
    return np.minimum(np.einsum("in,in->n", columns, np.linalg.pinv(gram) @ columns), 0.9999)


def robust_least_squares(design, values, name="bisquare", tune=None):
    """The `Reweighted` that fits `design` (n, parameters) · solution to `values` (n,).

    No constant column is added. `converged` is False after 50 passes: the bisquare may alternate
    between solutions. Raises `BrdfkitError` unless there are more values than parameters.

    >>> x = np.arange(5.0)
    >>> robust_least_squares(np.stack([np.ones(5), x], 1), 2 * x).solution.round(6)
    array([-0.,  2.])
    """
    design, values = np.asarray(design, float), np.asarray(values, float)
    _require_more_samples(*design.shape)
    lever = np.sqrt(1 - leverages(design.T))
    rank, least = np.linalg.matrix_rank(design), least_scale(values)

    def solve(weights, _before=None):
        root = np.sqrt(weights)
        return np.linalg.lstsq(design * root[:, None], values * root, rcond=None)[0]

    def weigh(solution):
        return sample_weights((values - design @ solution) / lever, name, rank, least, tune)

    return reweight(solve, weigh, solve(np.ones(len(values))))


def robust_search(problem, space, u, name, report):
    """The `Reweighted` of a fit; `u`: its optimum where all samples count alike.

    A solution is the coordinates u, then the model's weights (channels, lobes). The weights of the
    samples are (channels, n): a sample may count less in one channel than in another. The leverages
    are those of the linear parameters.
    """

    def split(solution):
        return solution[: len(u)], solution[len(u) :].reshape(problem.channels, -1)

    def residuals_at(solution):
        u, weights = split(solution)
        return problem.residuals(space.values(u) | space.fixed, weights)

    def add_weights(problem, u):
        return np.concatenate([u, problem.solve(space.values(u) | space.fixed).ravel()])

    # Leverages and the least scale do not change from pass to pass
    start, root = add_weights(problem, u), np.sqrt(problem.importance)
    rank = len(start) // problem.channels
    _require_more_samples(len(root), rank)
    levers = [np.sqrt(1 - leverages(columns)) for columns in residuals_at(start)[1]]
    least = [least_scale(root * np.asarray(target)) for target in problem.targets]
    passes = iter(range(1, PASSES + 1))

    def weigh(solution):
        report(next(passes), PASSES)
        residuals, _ = residuals_at(solution)
        return np.array(
            [
                sample_weights(r / lever, name, rank, floor)
                for r, lever, floor in zip(residuals, levers, least, strict=True)
            ]
        )

    def solve(weights, before):
        again = problem.reweighted(weights)
        return add_weights(again, slsqp(again, space, split(before)[0]).u if space.names else u)

    # A search is less precise than the solution of a linear problem
    return reweight(solve, weigh, start, 1e-5 if space.names else TOLERANCE)
