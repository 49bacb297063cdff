"""E² of one colour channel as a function of its weights, and the weights that minimise it."""

from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.fitting.loss import Loss
from brdfkit.fitting.weights import (
    make_positive_definite,
    minimise_quadratic,
    newton,
    weighted_gram,
)
from brdfkit.model import double_precision


@dataclass(frozen=True, eq=False)
class Channel:
    """One channel of a `Problem` at fixed shape parameters.

    `plain`, `squared` (lobes, n): the lobes, times κ, whose factors are the weights and the squared
    weights, `squared` None if there are none; `measured` (n,): κR; `target`: g(κR), and
    `importance`, the factor of each sample's squared difference, as Dr.Jit (n,); `bounded`
    (lobes,): which weights may not be negative.
    """

    loss: Loss
    plain: np.ndarray
    squared: np.ndarray | None
    measured: np.ndarray
    target: Any
    importance: Any
    bounded: np.ndarray

    def solve(self):
        """The best weights (lobes,)."""
        # Linear least squares, with g linearised at the measured values: exact if g is the
        # identity, otherwise the start of Newton's method
        slope = self.loss.dg(double_precision.array(self.measured))
        weight = np.asarray(self.importance * slope * slope)
        gram, moment = weighted_gram(self.plain, weight), self.plain @ (weight * self.measured)
        start = minimise_quadratic(gram, moment, self.bounded)
        if self.loss.linear and self.squared is None:
            return start
        return newton(self.expand, start, self.bounded)

    def expand(self, weights):
        """E², half its gradient by the weights, and half its Hessian, made positive definite."""
        model, columns = self.mix(weights)
        # Per sample: E² and half its first and second derivative by the model's value
        residual = self.loss.g(model) - self.target
        slope, curvature = self.loss.dg(model), self.loss.ddg(model)
        first = self.importance * residual * slope
        second = self.importance * (slope * slope + residual * curvature)
        squares = self.importance * residual * residual
        dr.eval(first, second, squares)
        first, second = np.asarray(first), np.asarray(second)
        # By the weights: the chain rule, and the second derivative of squared weights
        hessian = weighted_gram(columns, second)
        if self.squared is not None:
            hessian = hessian + np.diag(2 * self.squared @ first)
        return add_up(squares), columns @ first, make_positive_definite(hessian)

    def mix(self, weights):
        """The model at the samples, as Dr.Jit (n,), and its derivatives (lobes, n) by `weights`."""
        columns, mixture = self.plain, weights @ self.plain
        if self.squared is not None:
            columns = self.plain + 2 * weights[:, None] * self.squared
            mixture = mixture + weights**2 @ self.squared
        model = double_precision.array(mixture)
        # Weights that may be negative can make the model negative, where g is not defined
        return model if self.loss.linear else dr.maximum(model, 0), columns


def add_up(x):
    """The sum of an array of Dr.Jit's, as a float."""
    # Dr.Jit sums an evaluated array in a fixed order: the fit is reproducible to the last digit
    return to_float(dr.sum(x))


def to_float(x):
    """An array of Dr.Jit's with one entry, as a float."""
    return float(np.asarray(x).reshape(-1)[0])
