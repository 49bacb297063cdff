"""The problem of a fit: samples, a model and a loss, as a function of the shape parameters.

The weights are solved inside, per channel (variable projection), so that the search sees only
the shape parameters x. At the best weights the derivative of E² by x is the partial one with
the weights held fixed (envelope theorem), which Dr.Jit gives exactly.
"""

import drjit as dr
import numpy as np

from brdfkit import backend
from brdfkit.fitting.weights import bounded_quadratic


class Problem:
    """E² of a model on `Samples`, all of them valid, in units of that of a black model."""

    def __init__(self, model, samples, loss):
        cosines, importance = loss.geometry(samples)
        Float64 = backend.float64()
        self.model, self.loss = model, loss
        self.channels = samples.values.shape[1]
        self.wi, self.wo = backend.vector(samples.wi), backend.vector(samples.wo)
        self.cosines = Float64(cosines)
        values = loss.target(samples.values)
        self.measured = [Float64(np.ascontiguousarray(v * cosines)) for v in values.T]
        self.targets = [loss.g(m) for m in self.measured]

        # The loss itself is scale · √E²
        self.importance = Float64(importance / loss.normaliser(importance, self.channels))
        black = loss.g(Float64(0.0))
        squares = sum(_sum(self.importance * dr.square(black - t)) for t in self.targets)
        self.scale = squares**0.5 or 1.0
        self.importance /= self.scale**2
        dr.eval(self.targets, self.importance)

    def lobes(self, values):
        """The lobes times κ, each (n,), at `values` of the shape parameters."""
        terms = self.model.bind(values).terms()
        return [self.cosines * lobe.eval(self.wi, self.wo) for _, lobe in terms]

    def solve(self, values):
        """The best weights (channels, lobes) ≥ 0 at numbers `values` of the shape parameters."""
        lobes = self.lobes({name: backend.scalar(v) for name, v in values.items()})
        dr.eval(lobes)
        return np.array([self._solve_channel(lobes, c) for c in range(self.channels)])

    def _solve_channel(self, lobes, c):
        # Linearised about the data: exact where g is the identity, else the start of Newton's
        slope = self.loss.dg(self.measured[c])
        weight = self.importance * slope * slope
        gram = _symmetric(
            [[_sum(weight * a * b) for b in lobes[: i + 1]] for i, a in enumerate(lobes)]
        )
        moment = np.array([_sum(weight * a * self.measured[c]) for a in lobes])
        solution = bounded_quadratic(gram, moment)
        return solution if self.loss.linear else self._newton(lobes, c, solution)

    def _newton(self, lobes, c, solution):
        """Newton's method with the bounds, from a start near the solution."""
        error, gradient, hessian = self._expand(lobes, c, solution)
        for _ in range(30):
            proposed = bounded_quadratic(hessian, hessian @ solution - gradient)
            step = proposed - solution
            for _halving in range(12):
                trial = solution + step
                expansion = self._expand(lobes, c, trial)
                if expansion[0] <= error * (1 + 1e-14):
                    break
                step = step / 2
            else:
                return solution
            solution, (error, gradient, hessian) = trial, expansion
            if np.all(np.abs(step) <= 1e-9 * np.abs(solution).max(initial=1e-9)):
                break
        return solution

    def _expand(self, lobes, c, solution):
        """E² of a channel with gradient and (positive definite) Hessian by the weights, halved."""
        model = self._mixture(lobes, solution)
        residual = self.loss.g(model) - self.targets[c]
        slope, curvature = self.loss.dg(model), self.loss.ddg(model)
        first = self.importance * residual * slope
        second = self.importance * (slope * slope + residual * curvature)
        dr.eval(residual, first, second)
        error = _sum(self.importance * residual * residual)
        gradient = np.array([_sum(first * a) for a in lobes])
        hessian = _symmetric(
            [[_sum(second * a * b) for b in lobes[: i + 1]] for i, a in enumerate(lobes)]
        )
        eigenvalues, vectors = np.linalg.eigh(hessian)
        eigenvalues = np.maximum(np.abs(eigenvalues), 1e-12 * np.abs(eigenvalues).max() + 1e-300)
        return error, gradient, (vectors * eigenvalues) @ vectors.T

    def _mixture(self, lobes, solution):
        return sum(backend.scalar(a) * lobe for a, lobe in zip(solution, lobes, strict=True))

    def error(self, values, weights):
        """E² at `values` of the shape parameters and `weights` (channels, lobes)."""
        return _sum(self._error({n: backend.scalar(v) for n, v in values.items()}, weights))

    def error_and_gradient(self, values, fixed, weights):
        """E² and its derivatives by `values`, with `fixed` and the weights held."""
        if not backend.differentiable():
            gradient = self._differences(values, fixed, weights)
            return self.error(values | fixed, weights), gradient
        bound = {name: backend.scalar(v) for name, v in (values | fixed).items()}
        for name in values:
            dr.enable_grad(bound[name])
        total = dr.sum(self._error(bound, weights))
        dr.backward(total)
        return _number(dr.detach(total)), np.array([_number(dr.grad(bound[n])) for n in values])

    def _error(self, bound, weights):
        lobes = self.lobes(bound)
        squares = 0
        for c in range(self.channels):
            model = self._mixture(lobes, weights[c])
            squares = squares + dr.square(self.loss.g(model) - self.targets[c])
        return self.importance * squares

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


def _symmetric(lower_rows):
    n = len(lower_rows)
    return np.array([[lower_rows[max(i, j)][min(i, j)] for j in range(n)] for i in range(n)])
