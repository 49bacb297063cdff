"""Computes the weights, gradients and Hessians of a robust fit.

In a robust fit the samples of a `Problem` have weights that depend on their residuals.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.regression.problem.box_quadratic import minimise_in_box
from brdfkit.regression.problem.expansion import Expansion
from brdfkit.regression.problem.parameter_space import join_point, make_point_limits
from brdfkit.regression.problem.problem import Problem
from brdfkit.regression.robust.reweighting import (
    WEIGHTS,
    compute_leverages,
    compute_smallest_scale,
    estimate_residual_scale,
    require_more_samples_than_parameters,
)

# The derivative of the median residual is estimated from the samples next to it: one in this many
MEDIAN_SHARE = 200
# Step of a scaled residual in the central difference that differentiates its weighted value
DIFFERENCE_STEP = 1e-5


@dataclass(frozen=True, eq=False)
class Point:
    """A point of the search: the parameters of the model, and the residuals of the samples.

    `u` (1, shapes): coordinates of the shape parameters; `weights` (1, channels, lobes): weights of
    the lobes; `residuals`: residuals (n,) of the n samples in each channel.
    """

    u: np.ndarray
    weights: np.ndarray
    residuals: list[np.ndarray]

    def to_vector(self) -> FloatArray:
        """Return the k parameters of the point as a vector: coordinates, then weights."""
        return join_point(self.u, self.weights)[0]


class RobustProblem:
    """A `Problem` whose samples are weighted by a weight function of their residuals.

    `u` (1, shape parameters) and `weights` (1, channels, lobes): the optimum with equal weights of
    the samples. `name`: the weight function in `WEIGHTS`. `part`: a problem on fewer samples, from
    which Hessians are estimated, by default the problem itself; `rows`: the indices of its samples.

    A point has k parameters. The methods take `scales`: for each channel the scale of its
    residuals' noise, times the constant of the weight function. A residual is the loss's
    difference at a sample, times the root √w of the sample's weight. An outlier should be found by
    the difference alone. Residuals are therefore divided by `levers`, √w √(1 - leverage), which
    removes the weight, and the pull of the sample on its own fit.
    """

    def __init__(
        self,
        problem: Problem,
        u: FloatArray,
        weights: FloatArray,
        name: str,
        part: Problem | None = None,
        rows: Any = slice(None),
    ) -> None:
        self.problem, self.part, self.rows = problem, part or problem, rows
        self.function, self.tune, self.rho = WEIGHTS[name]
        self.rank = u.shape[1] + weights.shape[2]
        require_more_samples_than_parameters(len(problem.samples.wi), self.rank)
        # What follows stays the same in all passes; `metric` measures how a step changes the model
        self.metric = self.part.expand_at_weights(u, weights).hessian[0]
        root = np.sqrt(problem.importance / problem.importance.mean())
        root[root == 0] = 1.0  # a sample of weight 0 has residual 0, whatever divides it
        self.levers = [root * np.sqrt(1 - h) for h in self._find_leverages(u, weights)]
        black = problem.compute_residuals(u, 0 * weights)
        self.least = [compute_smallest_scale(target / root) for target in black]
        self.spread = np.sqrt(sum(len(t) * np.var(t) for t in black)) or 1.0
        self.low, self.high = make_point_limits(u.shape[1], problem.channels, problem.weight_limits)

    def _find_leverages(self, u: FloatArray, weights: FloatArray) -> list[FloatArray]:
        """Return the leverages (n,) of the samples in each channel, for the lobes' weights.

        They are exact, or with a part of the samples, estimated from the part. Under a linear loss
        they are equal in all channels.
        """
        problem = self.problem
        channels = slice(0, 1 if problem.linear else None)
        if self.part is problem:
            blocks = [own for _, own in _iterate_weight_derivatives(problem, u, weights, channels)]
            found = [
                compute_leverages(np.concatenate(own, axis=1)) for own in zip(*blocks, strict=True)
            ]
            return found * (problem.channels // len(found))
        # The part's samples have larger weights, which stand for all; so its Gram matrices do, too
        blocks = [own for _, own in _iterate_weight_derivatives(self.part, u, weights, channels)]
        inverses = []
        for own in zip(*blocks, strict=True):
            gram = sum(columns @ columns.T for columns in own)
            inverses.append(np.linalg.pinv(gram, hermitian=True))
        found = [np.empty(len(problem.samples.wi)) for _ in inverses]
        for rows, own_columns in _iterate_weight_derivatives(problem, u, weights, channels):
            for h, inverse, columns in zip(found, inverses, own_columns, strict=True):
                lever = np.einsum("an,an->n", columns, inverse @ columns)
                h[rows] = np.minimum(lever, 0.9999)
        return found * (problem.channels // len(found))

    def use_all_samples(self) -> None:
        """Compute Hessians from all samples from now on, instead of a part of them."""
        self.part, self.rows = self.problem, slice(None)

    def make_point(self, u: FloatArray, weights: FloatArray) -> Point:
        """Return the `Point` with coordinates `u` and lobe `weights`, and its residuals."""
        return Point(u, weights, self.problem.compute_residuals(u, weights))

    def take_step(self, point: Point, step: FloatArray) -> Point:
        """Return the `Point` after a `step` (k,) of the parameters, moved into their bounds."""
        shapes = point.u.shape[1]
        moved = point.weights + step[shapes:].reshape(point.weights.shape)
        u = np.clip(point.u + step[:shapes], 0, 1)
        return self.make_point(u, np.clip(moved, *self.problem.weight_limits))

    def estimate_scales(self, point: Point) -> list[float]:
        """Return the scale of the residuals' noise in each channel, at a point."""
        adjusted = [r / lever for r, lever in zip(point.residuals, self.levers, strict=True)]
        return [
            self.tune * estimate_residual_scale(r, self.rank, least)
            for r, least in zip(adjusted, self.least, strict=True)
        ]

    @property
    def is_linear(self) -> bool:
        """Whether the residuals are linear in all parameters, of which none has a bound."""
        problem = self.problem
        unbounded = not problem.space.names and bool(np.isinf(problem.weight_limits).all())
        return bool(problem.linear and unbounded)

    def weigh_residuals(self, channel: int, residuals: FloatArray) -> FloatArray:
        """Return the samples' weights ω (n,) that follow from the residuals (n,) of a channel."""
        adjusted = residuals / self.levers[channel]
        scale = estimate_residual_scale(adjusted, self.rank, self.least[channel])
        return self.function(adjusted / (self.tune * scale))

    def scale_residuals(self, point: Point, scales: list[float]) -> list[FloatArray]:
        """Return the scaled residuals r (n,) in each channel, arguments of the weight function.

        They are the residuals over their `levers` and `scales`.
        """
        both = zip(point.residuals, self.levers, scales, strict=True)
        return [residual / (lever * scale) for residual, lever, scale in both]

    def compute_merit(self, point: Point, scales: list[float]) -> float:
        """Return the merit, the function of the parameters that a pass reduces at constant scales.

        It is the sum of lever² ρ(r) over samples and channels, in units of squared residuals, where
        ρ is the integral of ω r and ω the weight function.
        """
        each = zip(self.scale_residuals(point, scales), self.levers, scales, strict=True)
        return sum(scale**2 * (lever**2 * self.rho(r)).sum() for r, lever, scale in each)

    def compute_weights_and_slopes(
        self, u: FloatArray, weights: FloatArray
    ) -> tuple[list[FloatArray], list[FloatArray]]:
        """Return the samples' weights ω at given parameters, and the derivatives of ω r by r.

        Both are lists of arrays (n,) by channel; r are the scaled residuals.
        """
        point = self.make_point(u, weights)
        ratios = self.scale_residuals(point, self.estimate_scales(point))
        return [self.function(r) for r in ratios], [
            self._differentiate_weighted_residual(r) for r in ratios
        ]

    def expand_weighted_loss(
        self, point: Point, factors: list[FloatArray]
    ) -> tuple[FloatArray, FloatArray]:
        """Return the gradient (k,) and Hessian (k, k) of the squared loss with weighted samples.

        `factors`: weights (n,) of the samples in each channel, which are constant.
        """
        own = self.part is self.problem
        here = self._expand_weighted_problem(self.problem, point, factors, own)
        if not own:
            factors = [f[self.rows] for f in factors]
        hessian = (
            here.hessian
            if own
            else self._expand_weighted_problem(self.part, point, factors).hessian
        )
        return here.gradient[0], hessian[0]

    def compute_newton_matrix(self, point: Point, ratios: list[FloatArray]) -> FloatArray:
        """Return Newton's matrix (k, k), the exact Hessian of the merit for constant scales.

        Unlike the Hessian of `expand_weighted_loss`, it includes the change of the samples'
        weights. `ratios`: scaled residuals (n,) in each channel.
        """
        slopes = [self._differentiate_weighted_residual(r[self.rows]) for r in ratios]
        return self._expand_weighted_problem(self.part, point, slopes).hessian[0]

    def differentiate_scales(
        self, point: Point, ratios: list[FloatArray], scales: list[float]
    ) -> tuple[FloatArray, FloatArray]:
        """Return ∂g/∂ln s (k, channels) and ∂ln s/∂z (channels, k) for Newton's step.

        g is the gradient of the weighted squared loss, s the scale of the residuals in a channel,
        and z the vector of k parameters. `ratios`: scaled residuals (n,) in each channel.
        """
        inner = [r[self.rows] for r in ratios]
        changes = [self.function(r) - self._differentiate_weighted_residual(r) for r in inner]
        medians = [
            self._weigh_samples_at_median(c, *pair)
            for c, pair in enumerate(zip(inner, scales, strict=True))
        ]
        of_gradient, of_scale = (
            self._compute_channel_gradients(point, factors) for factors in (changes, medians)
        )
        return of_gradient.T, of_scale

    def find_best_step(self, hessian: FloatArray, gradient: FloatArray, point: Point) -> FloatArray:
        """Return the step (k,) that minimises a quadratic function within the bounds."""
        z = point.to_vector()
        return minimise_in_box(hessian[None], gradient[None], self.low - z, self.high - z)[0]

    def _compute_channel_gradients(self, point: Point, factors: list[FloatArray]) -> FloatArray:
        """Return the gradient of each channel's squared loss (channels, k), from the part.

        `factors`: weights (n,) of the part's samples in each channel.
        """
        here = self._expand_weighted_problem(self.part, point, factors, curvature=False)
        return here.split_gradient()[0]

    def _weigh_samples_at_median(self, channel: int, r: FloatArray, scale: float) -> FloatArray:
        """Return weights (n,) of the part's samples for the gradient of the scale of the noise.

        With them, the gradient of the weighted squared loss is the gradient of ln s, where s is the
        scale of the residuals in a `channel`. Only samples with scaled residuals `r` next to the
        median have weight, because the median determines s.
        """
        weights = np.zeros(len(r))
        if scale <= self.tune * self.least[channel] * (1 + 1e-9):
            return weights
        median, count = 0.6745 / self.tune, max(len(r) // MEDIAN_SHARE, 2)
        near = np.argpartition(np.abs(np.abs(r) - median), count - 1)[:count]
        levers = self.levers[channel]
        size = np.abs(r[near]) * median * (scale * levers[self.rows][near]) ** 2
        weights[near] = 1 / (size * count * (len(levers) / len(r)))
        return weights

    def _expand_weighted_problem(
        self, problem: Problem, point: Point, factors: list[FloatArray], curvature: bool = True
    ) -> Expansion:
        """Return the `Expansion` of the squared loss with samples weighted by `factors`."""
        problem.factors = factors
        try:
            sums = problem.compute_sums(point.u, point.weights, curvature)
        finally:  # Ctrl-C must not leave the factors in the problem
            problem.factors = None
        return Expansion.from_sums(problem.columns, problem.space, sums, point.u, point.weights)

    def _differentiate_weighted_residual(self, r: FloatArray) -> FloatArray:
        """Return the derivatives (n,) of ω r by the scaled residuals r, with the weight ω."""
        steps = -DIFFERENCE_STEP, DIFFERENCE_STEP
        ends = [self.function(r + step) * (r + step) for step in steps]
        return (ends[1] - ends[0]) / (2 * DIFFERENCE_STEP)


def _iterate_weight_derivatives(
    problem: Problem, u: FloatArray, weights: FloatArray, channels: slice
) -> Iterator[tuple[slice, list[FloatArray]]]:
    """Yield each block's sample indices, and derivatives of residuals with respect to lobe weights.

    The derivatives are arrays (lobes, samples), for some of the `channels`.
    """
    for rows, _, jacobians in problem.iterate_jacobians(u, weights, channels):
        yield rows, [jacobian[u.shape[1] :] for jacobian in jacobians]
