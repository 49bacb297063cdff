"""Estimates how certain the parameters of a fit are: their covariance and standard errors.

The covariance is the sandwich estimator of Eicker, Huber and White, H⁻¹ (Σ g gᵀ) H⁻¹. H is the
Gauss-Newton Hessian of the squared loss E². g, the "score" of a sample, is its contribution to the
gradient of E², summed over channels and divided by √(1 - its leverage) [MacKinnon & White 1985].
The estimator assumes that samples are independent. It assumes neither that the noise of all samples
is equally large nor that the channels of a sample are independent.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from brdfkit.core.array_types import BoolArray, FloatArray
from brdfkit.regression.certainty_notes import (
    describe_parameter_trade_offs,
    describe_undetermined_parameters,
)
from brdfkit.regression.certainty_scores import (
    ABSENT,
    SINGULAR,
    compute_scores,
    find_undetermined_at_bounds,
)
from brdfkit.regression.problem.parameter_space import join_point
from brdfkit.regression.problem.problem import Problem
from brdfkit.regression.problem.subset import draw_subset

# With more samples than this, the covariance is estimated from half this number, drawn at random,
# which saves time
MANY_SAMPLES = 40_000
# A parameter nearer to its bound than this share of its range counts as on the bound
ON_BOUND = 1e-6


@dataclass(frozen=True)
class Certainty:
    """The covariance of those parameters of a fit that the data determine, and notes on the rest.

    `names`: the parameters that the data determine, (n,), weights of lobes with their channel, such
    as "diffuse_reflectance[0]"; `covariance`: their covariance matrix as n rows; `freedom`: the
    degrees of freedom of their variances, (n,); `undetermined`: sentences on parameters that the
    data do not determine; `trades`: sentences on parameters that the data hardly distinguish;
    `numbers`: the number of measured values, samples times channels; `parameters`: the number of
    searched parameters. Fixed parameters, and parameters on a bound, appear neither in `names` nor
    in `undetermined`.
    """

    names: tuple[str, ...]
    covariance: tuple[tuple[float, ...], ...]
    freedom: tuple[float, ...]
    undetermined: tuple[str, ...]
    trades: tuple[str, ...]
    numbers: int
    parameters: int

    def compute_standard_errors(self) -> dict[str, float]:
        """Return the standard error of each determined parameter, by its name."""
        variances = np.diagonal(self.make_covariance_matrix())
        return dict(zip(self.names, np.sqrt(variances).tolist(), strict=True))

    def compute_half_widths(self) -> dict[str, float]:
        """Return half the width of each parameter's 95 % confidence interval, by its name.

        The intervals follow Student's t distribution with the parameter's degrees of freedom.
        """
        from scipy.special import stdtrit

        quantiles = stdtrit(np.array(self.freedom), 0.975).tolist()
        errors = self.compute_standard_errors().items()
        return {name: t * error for t, (name, error) in zip(quantiles, errors, strict=True)}

    def compute_information_criterion(self, loss: float, price: float) -> float:
        """Return an information criterion, N ln(E²) + `price` · k, to compare models of the data.

        E is the `loss`, N the number of measured values and k the number of parameters. Akaike's
        criterion has a `price` of 2 for each parameter.
        """
        with np.errstate(divide="ignore"):
            return float(self.numbers * 2 * np.log(loss) + price * self.parameters)

    def compute_bic(self, loss: float) -> float:
        """Return the Bayesian information criterion of a fit with the loss E = `loss`."""
        return self.compute_information_criterion(loss, np.log(self.numbers))

    def make_covariance_matrix(self) -> NDArray[np.float64]:
        """Return the covariance of the determined parameters as a NumPy array (n, n)."""
        return np.array(self.covariance).reshape(len(self.names), len(self.names))

    def without_standard_errors(self, numbers: int) -> Certainty:
        """Return the `Certainty` without covariance but with all its notes.

        It is that of a fit to pictures or to a completed table, where standard errors would mean
        nothing: pixels that show the same samples, and cells that follow from the same values, do
        not have independent errors. `numbers`: the number of values that were fitted.
        """
        return replace(self, names=(), covariance=(), freedom=(), numbers=numbers)

    def compute_correlation(self) -> NDArray[np.float64]:
        """Return the correlations (n, n) between the determined parameters."""
        root = np.sqrt(np.maximum(np.diagonal(self.make_covariance_matrix()), 1e-300))
        return self.make_covariance_matrix() / np.outer(root, root)


def make_confidence_intervals(values: Mapping[str, Any], half: Mapping[str, Any]) -> dict[str, Any]:
    """Return confidence intervals (low, high) by parameter: `values` less and plus half a width.

    `values`: a number for each name, or a tuple for the channels of a weight; `half`: half the
    widths of the intervals, in the same form.
    """
    limits = {}
    for name, value in values.items():
        if isinstance(value, tuple):
            pairs = zip(value, half[name], strict=True)
            limits[name] = tuple((v - h, v + h) for v, h in pairs)
        else:
            limits[name] = (value - half[name], value + half[name])
    return limits


def compute_certainty(
    problem: Problem,
    u: FloatArray,
    weights: FloatArray,
    passes: tuple[list[FloatArray], list[FloatArray]] | None = None,
    rng: np.random.Generator | None = None,
) -> Certainty:
    """Return the `Certainty` of the parameters at which a search has minimised a `Problem`.

    `u` (1, shapes): coordinates of the shape parameters; `weights` (1, channels, lobes): weights of
    the lobes; `passes`: for a robust fit, the weights ω of the samples and the derivatives of ω r
    by the residual r, each a list by channel; `rng`: a generator that draws some of the
    samples if there are many.
    """
    names, free = _list_searched_parameters(problem, u, weights)
    at = join_point(problem.space.to_parameters(u), weights)[0]
    counted = problem.importance > 0
    numbers = int(counted.sum()) * problem.channels
    nothing = Certainty((), (), (), (), (), numbers, len(names))
    if numbers <= len(names) or not free.any():
        return nothing
    shares = np.ones(len(counted))
    if len(counted) > MANY_SAMPLES and rng is not None:
        part, rows = draw_subset(problem.samples, problem.shares, MANY_SAMPLES // 2, rng)
        whole, problem = problem.importance[rows], problem.with_samples(part)
        shares = whole / np.where(problem.importance > 0, problem.importance, 1)
        if passes:
            passes = [w[rows] for w in passes[0]], [slope[rows] for slope in passes[1]]
    residuals, jacobians = problem.compute_jacobians(u, weights)
    free |= find_undetermined_at_bounds(jacobians, free, u.shape[1])
    scores, hessian, scale = compute_scores(residuals, jacobians, free, u.shape[1], shares, passes)
    most = (numbers - len(names)) / problem.channels
    return compute_certainty_from_derivatives(
        names, free, at, scores, hessian, scale, numbers, most
    )


def compute_certainty_from_derivatives(
    names: Sequence[str],
    free: BoolArray,
    at: FloatArray,
    scores: FloatArray,
    hessian: FloatArray,
    scale: FloatArray,
    numbers: int,
    most: float,
) -> Certainty:
    """Return the `Certainty` of parameters from derivatives of the squared loss E² at its minimum.

    `names`: all n parameters; `free` (n,): whether a parameter is inside its bounds; `at` (n,):
    values of the parameters; `scores` (m, samples): contributions of the samples to the gradient of
    E² by the m free parameters; `hessian` (m, m): Hessian of E²; `scale` (m,): units of the
    parameters in `scores` and `hessian`; `numbers`: number of measured values; `most`: upper limit
    of the degrees of freedom of a variance.
    """
    # Along an eigenvector of the Hessian with eigenvalue 0 the loss stays the same: the data do not
    # determine the parameters that change
    values, vectors = np.linalg.eigh(hessian)
    open_ = np.abs(values) <= SINGULAR * max(values.max(), 1)
    inner = vectors[:, ~open_] / np.abs(values[~open_]) @ vectors[:, ~open_].T
    spread = inner @ scores
    covariance = spread @ spread.T * np.outer(scale, scale)
    freedom = _estimate_degrees_of_freedom(spread, most)
    loose = (np.abs(vectors[:, open_]) > ABSENT).any(axis=1)
    own = [name for name, is_free in zip(names, free, strict=True) if is_free]
    return Certainty(
        tuple(name for name, is_loose in zip(own, loose, strict=True) if not is_loose),
        tuple(map(tuple, covariance[np.ix_(~loose, ~loose)].tolist())),
        tuple(freedom[~loose].tolist()),
        describe_undetermined_parameters(
            own, vectors[:, open_] * scale[:, None], at[free], vectors[:, open_]
        ),
        describe_parameter_trade_offs(own, inner, scale, at[free], ~loose),
        numbers,
        len(names),
    )


def _estimate_degrees_of_freedom(spread: FloatArray, most: float) -> FloatArray:
    """Return the degrees of freedom (n,) of the variances of parameters, between 1 and `most`.

    They widen the confidence interval of a parameter that only a few samples determine. `spread`
    (n, samples): influence of each sample on each parameter; the variance of a parameter is the sum
    of squares of its row. The estimate is Satterthwaite's.
    """
    squares = spread * spread
    total, fourth = squares.sum(axis=1), (squares * squares).sum(axis=1)
    # The factor 3 is the kurtosis of Gaussian noise, its fourth moment over its squared variance
    return np.clip(3 * total**2 / np.maximum(fourth, 1e-300), 1, most)


def _list_searched_parameters(
    problem: Problem, u: FloatArray, weights: FloatArray
) -> tuple[list[str], BoolArray]:
    """Return the names of all searched parameters, and whether each is inside its bounds."""
    names = list(problem.space.names)
    for c in range(problem.channels):
        names += [f"{name}[{c}]" for name in problem.model.weights()]
    inside = (u[0] > ON_BOUND) & (u[0] < 1 - ON_BOUND)
    low, high = problem.weight_limits
    return names, np.concatenate([inside, ((weights[0] > low) & (weights[0] < high)).ravel()])
