"""Robust least squares: iteratively reweighted, so that outliers lose their say.

Every pass weighs a sample by its residual in the pass before,

    r = residual / (tune · s · √(1 - h)),   s = MAD / 0.6745,

h its leverage, MAD the median of the absolute residuals. [Holland & Welsch 1977]; [Kurt 2007, eqs.
5.14, 5.15], whose constants, and the order of the steps, are those of MATLAB's robustfit.

The bisquare removes noise, and with it any peak that a model cannot follow: compare the loss.
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
    """Where the passes ended: `solution`, `weights` (n,) of the samples, `passes`, `converged`."""

    solution: np.ndarray
    weights: np.ndarray
    passes: int
    converged: bool


def reweight(solve, weigh, start, tolerance=TOLERANCE):
    """Repeat `solve(weigh(solution), solution)` from the `start` until the solution rests.

    Solutions are arrays; they rest when no entry changes by more than `tolerance` of itself.
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
    """Weights (n,) by `residuals` (n,), already divided by √(1 - h).

    `name`: in `WEIGHTS`; `rank`: number of parameters, as many of the smallest residuals but one
    tell nothing of the scale; `least`: scale below which residuals count as rounding.
    """
    function, usual = WEIGHTS[name]
    ordered = np.sort(np.abs(residuals))
    scale = max(np.median(ordered[max(rank - 1, 0) :]) / 0.6745, least)
    return function(residuals / (scale * (tune or usual)))


def _require_more(samples, rank):
    """An error where every sample can be met: no residual then tells of the scale."""
    if samples <= rank:
        raise BrdfkitError(
            f"A robust fit needs more samples than parameters; here are {samples} and {rank}: "
            "give more samples, a simpler model, or no robust."
        )


def least_scale(values):
    """1e-6 of the spread of the `values` that are fitted."""
    return 1e-6 * np.std(values, ddof=1) or 1.0


def leverages(columns):
    """h (n,) of `columns` (parameters, n): the diagonal of the projection onto them, below 1."""
    gram = columns @ columns.T
    return np.minimum(np.einsum("in,in->n", columns, np.linalg.pinv(gram) @ columns), 0.9999)


def robust_least_squares(design, values, name="bisquare", tune=None):
    """The `Reweighted` that fits `design` (n, parameters) · solution to `values` (n,).

    A constant column is not added. Converged is False after 50 passes: the bisquare may go round
    in circles. Raises `BrdfkitError` unless there are more values than parameters.

    >>> x = np.arange(5.0)
    >>> robust_least_squares(np.stack([np.ones(5), x], 1), 2 * x).solution.round(6)
    array([-0.,  2.])
    """
    design, values = np.asarray(design, float), np.asarray(values, float)
    _require_more(*design.shape)
    lever = np.sqrt(1 - leverages(design.T))
    rank, least = np.linalg.matrix_rank(design), least_scale(values)

    def solve(weights, _before=None):
        root = np.sqrt(weights)
        return np.linalg.lstsq(design * root[:, None], values * root, rcond=None)[0]

    def weigh(solution):
        return sample_weights((values - design @ solution) / lever, name, rank, least, tune)

    return reweight(solve, weigh, solve(np.ones(len(values))))


def robust_search(problem, space, u, name, report):
    """The `Reweighted` of a fit from its optimum `u` without weights.

    The solution is u, then the weights (channels, lobes) of the model; a sample is weighed in
    each channel by itself, (channels, n). The leverages are those of the linear parameters.
    """

    def split(solution):
        return solution[: len(u)], solution[len(u) :].reshape(problem.channels, -1)

    def at(solution):
        u, weights = split(solution)
        return problem.residuals(space.values(u) | space.fixed, weights)

    def solved(problem, u):
        return np.concatenate([u, problem.solve(space.values(u) | space.fixed).ravel()])

    start, root = solved(problem, u), np.sqrt(problem.importance)
    rank = len(start) // problem.channels
    _require_more(len(root), rank)
    levers = [np.sqrt(1 - leverages(columns)) for columns in at(start)[1]]
    least = [least_scale(root * np.asarray(target)) for target in problem.targets]
    passes = iter(range(1, PASSES + 1))

    def weigh(solution):
        report(next(passes), PASSES)
        residuals, _ = at(solution)
        return np.array(
            [
                sample_weights(r / lever, name, rank, floor)
                for r, lever, floor in zip(residuals, levers, least, strict=True)
            ]
        )

    def solve(weights, before):
        again = problem.reweighted(weights)
        return solved(again, slsqp(again, space, split(before)[0]).u if space.names else u)

    # A search stops short of a linear solution's digits
    return reweight(solve, weigh, start, 1e-5 if space.names else TOLERANCE)
