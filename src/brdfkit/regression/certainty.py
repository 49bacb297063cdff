"""Estimates how certain the parameters of a fit are, by their covariance.

The covariance is the sandwich estimator of Eicker, Huber and White, H⁻¹ (Σ g gᵀ) H⁻¹. H is the
Gauss-Newton Hessian of E², the squared error. g is the contribution of a sample to the gradient of
E², with all its channels, over the square root of 1 - its leverage [MacKinnon & White 1985]. The
estimator assumes that samples are independent, but neither that their noise is equally large nor
that their channels are independent.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from brdfkit.core.array_types import BoolArray, FloatArray
from brdfkit.core.names import join_words
from brdfkit.regression.problem.parameter_space import find_channel_entries, join_point
from brdfkit.regression.problem.problem import Problem
from brdfkit.regression.problem.subset import draw_subset

# If there are more samples, half this number are drawn
MANY_SAMPLES = 40_000
# Smaller eigenvalues of a Hessian with unit diagonal are rounding, and so are smaller entries of
# its eigenvectors
SINGULAR, ABSENT = 1e-11, 1e-3
# Notes mention larger correlations, and smaller eigenvalues of the matrix of correlations
HIGH_CORRELATION, SMALL_EIGENVALUE = 0.99, 1e-5
# A parameter is on its bound within this share of its range
ON_BOUND = 1e-6


@dataclass(frozen=True)
class Certainty:
    """The covariance of the parameters that the data determine, and notes on the others.

    `names`: these parameters, weights with their channel as "diffuse_reflectance[0]"; `covariance`:
    its rows; `freedom`: the degrees of freedom of the variances; `undetermined`: sentences on
    parameters that the data do not determine; `trades`: sentences on parameters that the data
    hardly distinguish; `numbers`: how many numbers were measured, in samples with weight;
    `parameters`: how many parameters were searched. Fixed parameters, and parameters on a bound,
    are in neither `names` nor `undetermined`.
    """

    names: tuple[str, ...]
    covariance: tuple[tuple[float, ...], ...]
    freedom: tuple[float, ...]
    undetermined: tuple[str, ...]
    trades: tuple[str, ...]
    numbers: int
    parameters: int

    def compute_standard_errors(self) -> dict[str, float]:
        """Return the standard errors by the names of the parameters."""
        variances = np.diagonal(self.make_covariance_matrix())
        return dict(zip(self.names, np.sqrt(variances).tolist(), strict=True))

    def compute_half_widths(self) -> dict[str, float]:
        """Return half the widths of the 95 % confidence intervals, by Student's t, by name."""
        from scipy.special import stdtrit

        quantiles = stdtrit(np.array(self.freedom), 0.975).tolist()
        errors = self.compute_standard_errors().items()
        return {name: t * error for t, (name, error) in zip(quantiles, errors, strict=True)}

    def compute_criterion(self, loss: float, price: float) -> float:
        """Return N ln(E²) + `price` · k, with E = `loss`, N measured numbers and k parameters."""
        with np.errstate(divide="ignore"):
            return float(self.numbers * 2 * np.log(loss) + price * self.parameters)

    def compute_bic(self, loss: float) -> float:
        """Return the Bayesian information criterion of the error `loss`."""
        return self.compute_criterion(loss, np.log(self.numbers))

    def make_covariance_matrix(self) -> NDArray[np.float64]:
        """Return the covariance as an array (n, n)."""
        return np.array(self.covariance).reshape(len(self.names), len(self.names))

    def without_standard_errors(self, numbers: int) -> Certainty:
        """Return the certainty without standard errors, with another number of measured `numbers`.

        Standard errors have no meaning without independent noise: pixels show the same samples.
        """
        return replace(self, names=(), covariance=(), freedom=(), numbers=numbers)

    def compute_correlation(self) -> NDArray[np.float64]:
        """Return the correlations (n, n)."""
        root = np.sqrt(np.maximum(np.diagonal(self.make_covariance_matrix()), 1e-300))
        return self.make_covariance_matrix() / np.outer(root, root)


def make_intervals(values: Mapping[str, Any], half: Mapping[str, Any]) -> dict[str, Any]:
    """Return the intervals (low, high) by name: the `values`, numbers or tuples, ± `half`."""
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
    """Return the `Certainty` of a solution of a `Problem`.

    `u` (1, shapes), `weights` (1, channels, lobes): the solution; `passes`: for a robust fit, the
    weights ω of the samples and the derivatives of ω r by the residual r, each by channel; `rng`: a
    generator that draws a part if there are many samples.
    """
    names, free = _list_parameters(problem, u, weights)
    at = join_point(problem.space.to_parameters(u), weights)[0]
    counted = problem.importance > 0
    numbers = int(counted.sum()) * problem.channels
    nothing = Certainty((), (), (), (), (), numbers, len(names))
    if numbers <= len(names) or not free.any():
        return nothing
    shares = np.ones(len(counted))
    if len(counted) > MANY_SAMPLES and rng is not None:
        part, rows = draw_subset(problem.samples, problem.black_squares, MANY_SAMPLES // 2, rng)
        whole, problem = problem.importance[rows], problem.with_samples(part)
        shares = whole / np.where(problem.importance > 0, problem.importance, 1)
        if passes:
            passes = [w[rows] for w in passes[0]], [slope[rows] for slope in passes[1]]
    residuals, jacobians = problem.compute_jacobians(u, weights)
    free |= _find_undetermined_at_bounds(jacobians, free, u.shape[1])
    scores, hessian, scale = _compute_scores(residuals, jacobians, free, u.shape[1], shares, passes)
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
    """Return the `Certainty` of parameters from derivatives of E² at the end of a search.

    `names`: all parameters; `free` (n,): whether a parameter is not on a bound; `at` (n,): their
    values. For the free parameters, in units of `scale` (free,): `scores` (free, samples), the
    contribution of each sample to the gradient of E², and the `hessian`. `numbers`: how many
    numbers were measured; `most`: the largest degrees of freedom of a variance.
    """
    # Directions in which E² does not rise
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
        _describe_undetermined(
            own, vectors[:, open_] * scale[:, None], at[free], vectors[:, open_]
        ),
        _describe_trades(own, inner, scale, at[free], ~loose),
        numbers,
        len(names),
    )


def _estimate_degrees_of_freedom(spread: FloatArray, most: float) -> FloatArray:
    """Return the degrees of freedom (n,) of the variances, between 1 and `most`, by Satterthwaite.

    A variance is the sum of squares of a row of `spread` (n, samples). It has few degrees of
    freedom where a few samples determine a parameter.
    """
    squares = spread * spread
    total, fourth = squares.sum(axis=1), (squares * squares).sum(axis=1)
    # The fourth moment of Gaussian noise is 3 times the square of its second
    return np.clip(3 * total**2 / np.maximum(fourth, 1e-300), 1, most)


def _list_parameters(
    problem: Problem, u: FloatArray, weights: FloatArray
) -> tuple[list[str], BoolArray]:
    """Return the names of all searched parameters, and whether each is free, not on a bound."""
    names = list(problem.space.names)
    for c in range(problem.channels):
        names += [f"{name}[{c}]" for name in problem.model.weights()]
    inside = (u[0] > ON_BOUND) & (u[0] < 1 - ON_BOUND)
    return names, np.concatenate([inside, (weights[0] > problem.least).ravel()])


def _find_undetermined_at_bounds(
    jacobians: list[FloatArray], free: BoolArray, shapes: int
) -> BoolArray:
    """Return which parameters (n,) are shape parameters on a bound that E² does not determine.

    E² stays equal if such a parameter moves together with others. So rounding decides where along
    this direction a search ends, on the bound or off it. `free` (n,): whether a parameter is not on
    a bound; `jacobians`: derivatives (shapes + lobes, samples) by channel.
    """
    is_open = np.zeros(len(free), bool)
    moving = free.copy()
    # A parameter with a derivative of 0, as in a lobe without weight, trades off with no other
    moving[:shapes] |= np.any([jacobian[:shapes].any(axis=1) for jacobian in jacobians], axis=0)
    if (moving != free).any():
        hessian, _, _, _ = _sum_hessian(jacobians, moving, shapes)
        values, vectors = np.linalg.eigh(hessian)
        null = vectors[:, np.abs(values) <= SINGULAR * max(values.max(), 1)]
        is_open[moving] = (np.abs(null) > ABSENT).any(axis=1)
    return is_open & ~free


def _sum_hessian(
    jacobians: list[FloatArray], free: BoolArray, shapes: int
) -> tuple[FloatArray, FloatArray, list[Any], list[FloatArray]]:
    """Return the Hessian (n, n) of the `free` parameters in units that make its diagonal 1.

    Return these units (n,), too, and by channel the rows of its parameters and their derivatives.
    """
    where = np.cumsum(free) - 1
    rows, derivatives = [], []
    for c, jacobian in enumerate(jacobians):
        own = find_channel_entries(c, shapes, len(jacobian) - shapes)
        rows.append(where[own[free[own]]])
        derivatives.append(jacobian[free[own]])
    hessian = np.zeros((free.sum(), free.sum()))
    for own, jacobian in zip(rows, derivatives, strict=True):
        hessian[np.ix_(own, own)] += jacobian @ jacobian.T
    scale = 1 / np.sqrt(np.maximum(np.diagonal(hessian), 1e-300))
    return hessian * np.outer(scale, scale), scale, rows, derivatives


def _compute_scores(
    residuals: list[FloatArray],
    jacobians: list[FloatArray],
    free: BoolArray,
    shapes: int,
    shares: FloatArray,
    passes: tuple[list[FloatArray], list[FloatArray]] | None,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return scores (n, samples), the Hessian (n, n) and the scale (n,) of the free parameters.

    Scores are divided by the root of 1 - the leverage. The parameters are in units of the scale,
    which makes the diagonal of the Hessian 1.
    """
    hessian, scale, owns, jacobians = _sum_hessian(jacobians, free, shapes)
    inverse = np.linalg.pinv(hessian, rcond=SINGULAR, hermitian=True)
    scores = np.zeros((len(hessian), len(shares)))
    for c, (own, jacobian) in enumerate(zip(owns, jacobians, strict=True)):
        jacobian *= scale[own, None]
        lever = (jacobian * (inverse[np.ix_(own, own)] @ jacobian)).sum(axis=0) * shares
        factor = np.sqrt(shares / np.maximum(1 - lever, 1e-4))
        if passes:
            factor = factor * passes[0][c]
        scores[own] += jacobian * (residuals[c] * factor)
    if passes:
        hessian = np.zeros_like(hessian)
        for own, jacobian, slope in zip(owns, jacobians, passes[1], strict=True):
            hessian[np.ix_(own, own)] += (jacobian * slope) @ jacobian.T
    return scores, hessian, scale


def _describe_undetermined(
    names: Sequence[str], steps: FloatArray, at: FloatArray, vectors: FloatArray
) -> tuple[str, ...]:
    """Return a sentence on each of the `vectors` (n, count) along which E² does not rise.

    `steps`: the vectors in units of the parameters; `at` (n,): the values of the parameters.
    """
    sentences = {}
    # Relative changes; practically infinite for a parameter that is 0
    shares = np.clip(steps, -1e5, 1e5) / np.where(at == 0, 1e-300, at)[:, None]
    for share_of, vector in zip(shares.T, vectors.T, strict=True):
        relative: dict[str, float] = {}
        for j in np.argsort(-np.abs(vector)):
            if abs(vector[j]) > ABSENT:
                relative.setdefault(_strip_channel(names[j]), share_of[j])
        if len(relative) == 1:
            sentences[f"the data do not determine {next(iter(relative))}"] = True
            continue
        several = sorted(relative, key=lambda name: list(map(_strip_channel, names)).index(name))
        share = relative[several[0]] / relative[several[1]] if len(several) == 2 else np.nan
        sentences[_describe_trade(several, share)] = True
    return tuple(sentences)


def _describe_trade(names: Sequence[str], share: float) -> str:
    """Return a sentence on parameters that trade off.

    `share`: the relative change of the first of two parameters over the second's.
    """
    what = "a combination of them"
    if 0.8 < abs(share) < 1.25:
        what = "their product" if share < 0 else "their ratio"
    if len(names) > 4:
        names = [*names[:3], f"{len(names) - 3} other parameters"]
    return f"{join_words(names)} trade off: only {what} is determined"


def _strip_channel(name: str) -> str:
    """Return the name of a parameter without its channel."""
    return name.partition("[")[0]


def explain_undetermined(certainty: Certainty) -> str | None:
    """Return the message of a fit whose data do not determine all parameters, or None."""
    numbers, parameters = certainty.numbers, certainty.parameters
    if numbers < parameters:
        return f"underdetermined: the values are some of many that meet the {numbers} numbers"
    if numbers == parameters:
        return f"as many numbers as parameters, {numbers}: nothing tells how certain the values are"
    if certainty.undetermined:
        return "ended, and not all values are determined"
    return None


def _describe_trades(
    names: Sequence[str],
    inverse: FloatArray,
    scale: FloatArray,
    at: FloatArray,
    determined: BoolArray,
) -> tuple[str, ...]:
    """Return sentences on the parameters that the data hardly distinguish, whatever their noise.

    `inverse` (n, n): of the Hessian, in units of `scale` (n,); `at` (n,): the values of the
    parameters; `determined` (n,): whether the data determine a parameter.
    """
    (rows,) = np.nonzero(determined)
    errors = np.sqrt(np.diagonal(inverse))[rows]
    correlation = inverse[np.ix_(rows, rows)] / np.outer(errors, errors)
    relative = errors * scale[rows] / np.maximum(np.abs(at[rows]), 1e-300)
    plain = [_strip_channel(names[int(row)]) for row in rows]
    pairs: dict[tuple[str, str], tuple[float, float]] = {}
    for i, j in zip(*np.nonzero(np.triu(np.abs(correlation) > HIGH_CORRELATION, 1)), strict=True):
        pair, size = (plain[i], plain[j]), correlation[i, j]
        if plain[i] != plain[j] and abs(size) > abs(pairs.get(pair, [0])[0]):
            pairs[pair] = size, relative[i] / relative[j]
    worst, sentences = sorted(pairs.items(), key=lambda item: -abs(item[1][0])), []
    for pair, (size, share) in worst[:3]:
        trade = _describe_trade(pair, np.copysign(share, size))
        sentences.append(f"{trade} (correlation {size:.4f})")
    if len(worst) > 3:
        sentences.append(f"so do {len(worst) - 3} more pairs of parameters")
    if not worst and len(rows):
        values, vectors = np.linalg.eigh(correlation)
        strong = np.abs(vectors[:, 0]) > 0.1 * np.abs(vectors[:, 0]).max()
        several = list(dict.fromkeys(n for n, is_in in zip(plain, strong, strict=True) if is_in))
        if values[0] < SMALL_EIGENVALUE and len(several) > 1:
            sentences.append(_describe_trade(several, np.nan))
    return tuple(sentences)
