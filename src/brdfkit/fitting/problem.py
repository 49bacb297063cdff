"""The problem of a fit: samples, a model and a loss, as a function of the shape parameters.

The weights are solved inside, per channel (variable projection), so that the search sees only
the shape parameters x. At the best weights the derivative of E² by x is the partial one with
the weights held fixed (envelope theorem), which Dr.Jit gives exactly.
"""

import copy

import drjit as dr
import numpy as np

from brdfkit.errors import BrdfkitError
from brdfkit.fitting.undefined import require_finite, require_finite_slopes
from brdfkit.fitting.weights import bounded_quadratic, newton, weighted_gram
from brdfkit.model import double_precision


class Problem:
    """E² of a model on `Samples`, all of them valid, in units of that of a black model."""

    def __init__(self, model, samples, loss):
        cosines, importance = loss.geometry(samples)
        array = double_precision.array
        self.model, self.loss = model, loss
        self.bounded = np.array([model.parameters[n].bounds[0] >= 0 for n in model.weights()])
        self.wi, self.wo = double_precision.vector(samples.wi), double_precision.vector(samples.wo)
        self.cosines = array(cosines)
        self.measured = np.ascontiguousarray((loss.target(samples.values) * cosines[:, None]).T)
        self.channels = len(self.measured)
        self.targets = [loss.g(array(m)) for m in self.measured]

        # The loss itself is scale · √E²
        normaliser = loss.normaliser(importance, self.channels)
        if normaliser == 0:
            raise BrdfkitError(
                f"The {loss.name} loss weighs no sample, for all are seen at normal incidence; "
                "choose another loss."
            )
        importance = importance / normaliser
        black = loss.g(double_precision.float64()(0.0))
        squares = sum(_sum(array(importance) * dr.square(black - t)) for t in self.targets)
        self.scale = squares**0.5 or 1.0
        self.importance = importance / self.scale**2
        self.importances = [array(self.importance)] * self.channels
        dr.eval(self.targets, self.importances)

    def reweighted(self, weights):
        """The same problem with each sample counting `weights` (channels, n) times as much."""
        other = copy.copy(self)
        other.importances = [double_precision.array(self.importance * w) for w in weights]
        return other

    def lobes(self, values):
        """(lobes, lobes of the squared weights), times κ: lists of (n,), at `values` of the shape
        parameters; None where a weight has no square."""
        terms = self.model.bind(values).terms()
        plain = [self.cosines * lobe.eval(self.wi, self.wo) for _, lobe in terms]
        squared = [
            None if lobe.quadratic is None else self.cosines * lobe.quadratic(self.wi, self.wo)
            for _, lobe in terms
        ]
        return plain, squared

    def solve(self, values):
        """The best weights (channels, lobes) at numbers `values` of the shape parameters."""
        plain, squared = self.columns(values)
        return np.array([self._solve_channel(plain, squared, c) for c in range(self.channels)])

    def columns(self, values):
        """`lobes` at numbers, as NumPy (lobes, n); None if no weight has a square."""
        plain, squared = self.lobes(
            {name: double_precision.scalar(v) for name, v in values.items()}
        )
        dr.eval(plain, squared)
        plain = np.stack([np.asarray(lobe) for lobe in plain])
        require_finite(self.model, plain, self.wi, self.wo)
        if all(lobe is None for lobe in squared):
            return plain, None
        none = np.zeros(plain.shape[1])
        return plain, np.stack([none if q is None else np.asarray(q) for q in squared])

    def residuals(self, values, weights):
        """(residuals, their derivatives by the weights): lists by channel of (n,), (lobes, n).

        Their squares add up to E² of a problem that is not reweighted.
        """
        plain, squared = self.columns(values)
        root, residuals, derivatives = np.sqrt(self.importance), [], []
        for a, target in zip(weights, self.targets, strict=True):
            model, columns = self._mixture(plain, squared, a)
            residuals.append(root * np.asarray(self.loss.g(model) - target))
            derivatives.append(columns * (root * np.asarray(self.loss.dg(model) + 0 * model)))
        return residuals, derivatives

    def _solve_channel(self, plain, squared, c):
        # Linearised about the data: exact where g is the identity, else the start of Newton's
        measured = self.measured[c]
        slope = self.loss.dg(double_precision.array(measured))
        weight = np.asarray(self.importances[c] * slope * slope)
        gram, moment = weighted_gram(plain, weight), plain @ (weight * measured)
        start = bounded_quadratic(gram, moment, self.bounded)
        linear = self.loss.linear and squared is None
        if linear:
            return start
        return newton(lambda a: self._expand(plain, squared, c, a), start, self.bounded)

    def _expand(self, plain, squared, c, weights):
        """E² of a channel with gradient and (positive definite) Hessian by the weights, halved."""
        model, columns = self._mixture(plain, squared, weights)
        residual = self.loss.g(model) - self.targets[c]
        slope, curvature = self.loss.dg(model), self.loss.ddg(model)
        first = self.importances[c] * residual * slope
        second = self.importances[c] * (slope * slope + residual * curvature)
        squares = self.importances[c] * residual * residual
        dr.eval(first, second, squares)
        first, second, error = np.asarray(first), np.asarray(second), _sum(squares)
        hessian = weighted_gram(columns, second)
        if squared is not None:
            hessian = hessian + np.diag(2 * squared @ first)
        eigenvalues, vectors = np.linalg.eigh(hessian)
        eigenvalues = np.maximum(np.abs(eigenvalues), 1e-12 * np.abs(eigenvalues).max() + 1e-300)
        return error, columns @ first, (vectors * eigenvalues) @ vectors.T

    def _mixture(self, plain, squared, weights):
        """The model at the samples, and its derivatives (lobes, n) by the weights of a channel."""
        columns, mixture = plain, weights @ plain
        if squared is not None:
            columns = plain + 2 * weights[:, None] * squared
            mixture = mixture + weights**2 @ squared
        model = double_precision.array(mixture)
        # A trial step of free weights may leave the domain of g
        return model if self.loss.linear else dr.maximum(model, 0), columns

    def error(self, values, weights):
        """E² at `values` of the shape parameters and `weights` (channels, lobes)."""
        return _sum(
            self._error({n: double_precision.scalar(v) for n, v in values.items()}, weights)
        )

    def error_and_gradient(self, values, fixed, weights):
        """E² and its derivatives by `values`, with `fixed` and the weights held."""
        if not double_precision.differentiable():
            gradient = self._differences(values, fixed, weights)
            return self.error(values | fixed, weights), gradient
        bound = {name: double_precision.scalar(v) for name, v in (values | fixed).items()}
        for name in values:
            dr.enable_grad(bound[name])
        total = dr.sum(self._error(bound, weights))
        dr.backward(total)
        gradient = np.array([_number(dr.grad(bound[n])) for n in values])
        if not np.isfinite(gradient).all():
            require_finite_slopes(self.model, values | fixed, values, self.wi, self.wo)
        return _number(dr.detach(total)), gradient

    def _error(self, bound, weights):
        plain, squared = self.lobes(bound)
        squares = 0
        for c in range(self.channels):
            model = 0
            for a, lobe, quadratic in zip(weights[c], plain, squared, strict=True):
                a = double_precision.scalar(a)
                model = model + a * lobe + (0 if quadratic is None else a * a * quadratic)
            if not self.loss.linear:
                model = dr.maximum(model, 0)
            residual = self.loss.g(model) - self.targets[c]
            squares = squares + self.importances[c] * dr.square(residual)
        return squares

    def _differences(self, values, fixed, weights):
        """Differences within the bounds, where the backend has no derivatives."""
        gradient = []
        for name, value in values.items():
            low, high = self.model.parameters[name].bounds
            h = 1e-6 * max(abs(value), 1e-3)
            ends = max(value - h, low), min(value + h, high)
            below, above = (self.error(values | fixed | {name: v}, weights) for v in ends)
            gradient.append((above - below) / (ends[1] - ends[0]))
        return np.array(gradient)


def _sum(x):
    # Evaluated sums run in a fixed order: the fit is reproducible to the last digit
    return _number(dr.sum(x))


def _number(x):
    return float(np.asarray(x).reshape(-1)[0])
