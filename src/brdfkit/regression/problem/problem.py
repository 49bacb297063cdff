"""Computes the function that a fit minimises: the squared loss E² of a model on samples.

A point of the search consists of the coordinates u of the searched shape parameters, and of the
weights of the model's lobes in all channels. One kernel evaluates many points together, each of
them on all samples.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cached_property
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.array_types import FloatArray, JitFloat
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit import double_precision
from brdfkit.model import Model
from brdfkit.model.samples import Samples
from brdfkit.regression.losses.loss import Loss
from brdfkit.regression.problem.blocks import GROUP, Block, Blocks
from brdfkit.regression.problem.columns import Columns
from brdfkit.regression.problem.expansion import Expansion, make_derivative_matrix
from brdfkit.regression.problem.kernel import (
    can_record,
    compute_terms,
    evaluate_recorded,
    mix_columns,
    shares_curvature,
)
from brdfkit.regression.problem.not_finite import require_finite_columns, require_finite_loss
from brdfkit.regression.problem.parameter_space import Space
from brdfkit.regression.problem.subset import Shares
from brdfkit.regression.problem.sums import Sums, move_sums_to_weights, solve_weights


class Problem:
    """The squared loss E² of a model on samples, as a function of the model's parameters.

    `model`: the class; `samples`: valid samples; `loss`: the loss E; `space`: search space of the
    shape parameters. A model with negative weights is clamped at 0 where it is negative. There,
    the loss of a sample is constant, or if `extended`, continues with the slope that it has at 0.

    The methods take coordinates `u` (points, shapes) and `weights` (points, channels, lobes).
    """

    def __init__(
        self, model: type[Model], samples: Samples, loss: Loss, space: Space, extended: bool = False
    ) -> None:
        self.model, self.samples, self.loss, self.space = model, samples, loss, space
        self.columns = Columns.for_model(model, space.names, space.fixed)
        self.channels = samples.values.shape[1]
        numbers = range(self.channels)
        self.groups = [numbers[k : k + GROUP] for k in numbers[::GROUP]]
        bounds = [model.parameters[name].bounds for name in model.weights()]
        self.weight_limits = np.array(bounds, float).T  # lower and upper ones of the lobes
        self.clamped = not loss.linear and bool((self.weight_limits < 0).any())
        self.extended = extended
        self.recorded = len(self.groups) == 1 and can_record(model, loss)
        self.linear = loss.linear and (self.columns.powers < 2).all()
        self.factors: list[FloatArray] | None = None
        self._constant: tuple[list[JitFloat], FloatArray] | None = None

        importance = loss.importance(samples)
        if not importance.any():
            normal = samples.wi[:, 2].min() == 1
            why = (
                "at normal incidence, as here, its weights are 0" if normal else "all weights are 0"
            )
            raise BrdfkitError(
                f"The {loss.name} loss weighs no sample: {why}; choose another loss."
            )
        self.importance = importance
        self.blocks: Callable[[int], Iterator[Block]] = Blocks(samples, importance, loss)

    def with_samples(self, samples: Samples) -> Problem:
        """Return the problem of the same model and loss on other samples."""
        return Problem(self.model, samples, self.loss, self.space)

    @cached_property
    def black_squares(self) -> FloatArray:
        """The contributions (n,) of the samples to the squared loss of a black model.

        They show how much influence each sample may have on a fit.
        """
        squares = []
        for block in self.blocks(1):
            total = 0
            for group in self.groups:
                total += sum(dr.square(self.evaluate_difference(block, 0.0, c)[0]) for c in group)
                self._evaluate_channel_group(total)
            squares.append(np.asarray(block.importance * total))
        contributions = np.concatenate(squares)
        if not np.isfinite(contributions).all():
            black = np.zeros((1, self.channels, self.weight_limits.shape[1]))
            self._raise_if_not_finite(np.full((1, len(self.space.names)), 0.5), black)
        return contributions

    @cached_property
    def shares(self) -> Shares:
        """The probabilities with which samples are drawn if a part of them has to do."""
        return Shares.from_influence(self.samples, self.black_squares)

    def estimate_weights(self, u: FloatArray, evenly: bool = False) -> FloatArray:
        """Return weights (points, channels, lobes) to start from, given coordinates `u`.

        For a linear loss these are the weights with the least squared loss. Another loss is
        linearised at the measured values, or if `evenly`, replaced by the plain difference of the
        values.
        """
        sums = Sums.make_zeros(len(u), self.channels, len(self.columns))
        for block in self.blocks(len(u)):
            columns = self._evaluate_columns(block, u)
            fixed = sum(columns[k] for k in np.flatnonzero(self.columns.powers == 0))
            moments, weights = [], []
            for group in self.groups:
                for c in group:
                    value = block.measured[c]
                    value = value if self.loss.linear else dr.maximum(value, 0)
                    _, slope = self.evaluate_difference(block, value, c)
                    slope = 0 * slope + 1 if evenly else slope
                    weights.append(block.importance * slope * slope)
                    moments.append(weights[-1] * (fixed - value))
                self._evaluate_channel_group(columns, moments, weights)
            squares = [0 * block.importance]
            sums.add_samples(*self._evaluate_block(block, u, columns, squares, moments, weights))
        if not sums.is_finite():
            self._raise_if_not_finite(u)
        return solve_weights(self.columns, sums, self.weight_limits)

    def expand_loss(self, u: FloatArray, weights: FloatArray, curvature: bool = True) -> Expansion:
        """Return the quadratic approximation of the squared loss E² about points.

        It has no Hessian without `curvature`, which saves time. If E² is quadratic in the weights,
        the expansion is about the best weights in place of the given `weights`.
        """
        solve = self.linear and curvature and self.factors is None
        if solve:
            weights = np.zeros_like(weights)
        sums = self.compute_sums(u, weights, curvature)
        if solve:
            weights = solve_weights(self.columns, sums, self.weight_limits)
            sums = move_sums_to_weights(self.columns, sums, weights)
        return Expansion.from_sums(self.columns, self.space, sums, u, weights)

    def compute_sums(self, u: FloatArray, weights: FloatArray, curvature: bool = True) -> Sums:
        """Return the sums over all samples from which the squared loss and derivatives follow."""
        sums = Sums.make_zeros(len(u), self.channels, len(self.columns), curvature)
        for _, evaluated in self._evaluate_blocks(u, weights, curvature):
            sums.add_samples(*evaluated)
        if not sums.is_finite():
            self._raise_if_not_finite(u, weights)
        return sums

    def compute_jacobians(self, u: FloatArray, weights: FloatArray) -> list[list[FloatArray]]:
        """Return the residuals at one point and their derivatives, each as a list by channel.

        Residuals (n,) are the differences of the loss times the root of the sample's weight; those
        whose difference has a slope of 0 become 0. Derivatives (shapes + lobes, n) are with respect
        to the shape parameters themselves, not to their coordinates, and to the weights.
        """
        _, residuals, jacobians = zip(*self.iterate_jacobians(u, weights), strict=True)
        return [
            [np.concatenate(own, axis=-1) for own in zip(*blocks, strict=True)]
            for blocks in (residuals, jacobians)
        ]

    def iterate_jacobians(
        self, u: FloatArray, weights: FloatArray, channels: slice = slice(None)
    ) -> Iterator[tuple[slice, list[FloatArray], list[FloatArray]]]:
        """Yield the sample indices, residuals and derivatives of each block of samples.

        Derivatives are those of some `channels`, by default of all.
        """
        change = make_derivative_matrix(self.columns, weights, np.ones_like(u))[0]
        unit = np.eye(*change.shape[1:])  # of a model without slopes
        for block, (columns, _, moments, grams) in self._evaluate_blocks(u, weights):
            roots = [np.sqrt(gram[0]) for gram in grams]
            roots *= self.channels // len(roots)  # one for each channel, or one for all
            residuals = [
                moment[0] / np.where(root > 0, root, 1)
                for moment, root in zip(moments, roots, strict=True)
            ]
            own = zip(change[channels], roots[channels], strict=True)
            jacobians = [
                (columns[0][: len(by)] if np.array_equal(by, unit) else by @ columns[0]) * root
                for by, root in own
            ]
            yield block.rows, residuals, jacobians

    def _evaluate_blocks(
        self, u: FloatArray, weights: FloatArray, curvature: bool = True
    ) -> Iterator[tuple[Block, tuple[Any, ...]]]:
        """Yield each block of samples with the arguments that `Sums.add_samples` needs for it."""
        how = {"clamped": self.clamped, "extended": self.extended, "curvature": curvature}
        for block in self.blocks(len(u)):
            factors = self.factors and [
                double_precision.to_array(own[block.rows]) for own in self.factors
            ]
            if self.recorded and type(block) is Block:
                constant = self._find_constant_columns(block, u)
                columns, *terms = evaluate_recorded(
                    block,
                    self.columns,
                    self.space.to_parameters(u),
                    self._compute_column_factors(weights),
                    constant=constant[0],
                    factors=factors,
                    **how,
                )
                T = constant[1] if constant[0] else self._stack_columns(block, u, columns)
                yield block, self._convert_terms(block, T, *terms)
                continue
            columns = self._evaluate_columns(block, u)
            squares: list[JitFloat] = []
            moments: list[JitFloat] = []
            grams: list[JitFloat] = []
            for group in self.groups:
                model = self._evaluate_model(block, columns, weights[:, group])
                own = compute_terms(block, model, group, factors=factors, **how)
                squares.append(sum(own[0]))
                moments += own[1]
                grams += own[2][: 0 if grams and shares_curvature(block, factors) else None]
                self._evaluate_channel_group(columns, squares, moments, grams)
            yield block, self._evaluate_block(block, u, columns, squares, moments, grams)

    def expand_at_weights(
        self, u: FloatArray, weights: FloatArray, curvature: bool = True
    ) -> Expansion:
        """Return the quadratic approximation of the squared loss for the given `weights`."""
        sums = self.compute_sums(u, weights, curvature)
        return Expansion.from_sums(self.columns, self.space, sums, u, weights)

    def compute_residuals(self, u: FloatArray, weights: FloatArray) -> list[FloatArray]:
        """Return the residuals (n,) of the samples at one point, as a list by channel.

        The squared loss E² is the sum of their squares.
        """
        parts: list[list[JitFloat]] = []
        for block in self.blocks(1):
            columns, root = self._evaluate_columns(block, u), dr.sqrt(block.importance)
            parts.append([])
            for group in self.groups:
                model = self._evaluate_model(block, columns, weights[:, group])
                pairs = zip(group, model, strict=True)
                parts[-1] += [root * self.evaluate_difference(block, m, c)[0] for c, m in pairs]
                self._evaluate_channel_group(columns, parts[-1])
            dr.eval(parts[-1])
        return [np.concatenate([np.asarray(p) for p in part]) for part in zip(*parts, strict=True)]

    def evaluate_difference(
        self, block: Block, value: Any, channel: int
    ) -> tuple[JitFloat, JitFloat]:
        """Return the loss's difference of a model's `value` in a channel, and its derivative."""
        return block.evaluate_difference(value, channel, self.clamped, self.extended)

    def _evaluate_channel_group(self, *arrays: Any) -> None:
        """Evaluate the arrays of a group of channels, so that kernels stay small."""
        if len(self.groups) > 1:
            dr.eval(*arrays)

    def _evaluate_columns(self, block: Block, u: FloatArray) -> list[JitFloat]:
        """Return the model's columns at the samples of a block, a list of Dr.Jit arrays."""
        return block.evaluate_columns(self.columns, self.space.to_parameters(u))

    def _evaluate_model(
        self, block: Block, columns: list[JitFloat], weights: FloatArray
    ) -> list[JitFloat]:
        """Return the model's BRDF at the samples of a block, a Dr.Jit array for each channel."""
        spread = block.repeat_for_samples(self._compute_column_factors(weights))
        return mix_columns(columns[: len(self.columns.lobes)], spread)

    def _compute_column_factors(self, weights: FloatArray) -> FloatArray:
        """Return the factors of the model's values, (points, channels · values), from `weights`."""
        factors = weights[:, :, self.columns.lobes] ** self.columns.powers
        return factors.reshape(len(factors), -1)

    def _raise_if_not_finite(self, u: FloatArray, weights: FloatArray | None = None) -> None:
        """Raise a `BrdfkitError` that names a sample at which the loss is not finite, if any.

        `weights`: weights of the model's lobes; without them, the loss is evaluated at the measured
        values.
        """
        for block in self.blocks(len(u)):
            model = block.measured
            if weights is not None:
                model = self._evaluate_model(block, self._evaluate_columns(block, u), weights)
            for c, value in enumerate(model):
                both = self.evaluate_difference(block, value, c)
                require_finite_loss(block.loss, block, value, block.measured[c], *both)

    def _evaluate_block(
        self,
        block: Block,
        u: FloatArray,
        columns: list[JitFloat],
        squares: list[JitFloat],
        moments: list[JitFloat],
        weights: list[JitFloat],
    ) -> tuple[Any, ...]:
        """Evaluate the arrays of a block in one kernel, and return them for `Sums.add_samples`.

        `columns`: columns of the model; `squares`: lists of w d²; `moments`: w d d'; `weights`:
        w d'², where w is the weight of a sample, d the difference of the loss, d' its derivative.
        """
        total = sum(squares)
        dr.eval(columns, total, moments, weights)
        T = self._stack_columns(block, u, columns)
        return self._convert_terms(block, T, total, moments, weights)

    def _find_constant_columns(
        self, block: Block, u: FloatArray
    ) -> tuple[list[JitFloat], FloatArray]:
        """Return the columns of a model without shape parameters, if they are kept, as two arrays.

        They are kept for a block with all samples at one point, so that they are evaluated once.
        Otherwise the list is empty.
        """
        if self.space.names or block.count > 1 or len(block.wi.x) < len(self.samples.wi):
            return [], np.zeros((1, 0, 0))
        if self._constant is None:
            columns = self._evaluate_columns(block, u)
            dr.eval(columns)
            self._constant = columns, self._stack_columns(block, u, columns)
        return self._constant

    def _stack_columns(self, block: Block, u: FloatArray, columns: list[JitFloat]) -> FloatArray:
        """Return evaluated columns of a block as one array (points, columns, samples), finite."""
        T = np.stack([block.split_by_point(column) for column in columns], axis=1)
        return require_finite_columns(self.columns, T, block, self.space, u)

    def _convert_terms(
        self,
        block: Block,
        T: FloatArray,
        total: JitFloat,
        moments: list[JitFloat],
        weights: list[JitFloat],
    ) -> tuple[Any, ...]:
        """Return evaluated arrays of a block as NumPy arrays, for `Sums.add_samples`."""
        return (
            T,
            block.split_by_point(total),
            [block.split_by_point(m) for m in moments],
            [block.split_by_point(w) for w in weights],
        )
