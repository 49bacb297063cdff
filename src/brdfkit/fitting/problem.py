"""What a fit minimises: E² of a model on samples, as a function of the shape parameters.

For given shape parameters x, `solve` computes the best weights of each channel (variable
projection), so that the search runs over x alone. At the best weights, the derivative of E² by x
equals the partial derivative with the weights held fixed (envelope theorem). Dr.Jit computes it
exactly.
"""

import copy

import drjit as dr
import numpy as np

from brdfkit.errors import BrdfkitError
from brdfkit.fitting.channel_loss import Channel, add_up, to_float
from brdfkit.fitting.not_finite import require_finite, require_finite_slopes
from brdfkit.model import double_precision


class Problem:
    """E² of a model on `Samples`, all of them valid, divided by the E² of a black model.

    Arguments called `values` are the shape parameters by name.
    """

    def __init__(self, model, samples, loss):
        cosines, importance = loss.factors(samples)
        array = double_precision.array
        self.model, self.loss = model, loss
        self.bounded = np.array([model.parameters[n].bounds[0] >= 0 for n in model.weights()])
        self.wi, self.wo = double_precision.vector(samples.wi), double_precision.vector(samples.wo)
        self.cosines = array(cosines)
        # κR (channels, n), and g(κR) of each channel
        self.measured = np.ascontiguousarray((loss.target(samples.values) * cosines[:, None]).T)
        self.channels = len(self.measured)
        self.targets = [loss.g(array(m)) for m in self.measured]

        # A sample's importance is w / N, divided by the E² of a black model; the loss E is then
        # `scale` times the root of `squared_error`
        normaliser = loss.normaliser(importance, self.channels)
        if normaliser == 0:
            raise BrdfkitError(
                f"The {loss.name} loss weighs no sample, for all are seen at normal incidence; "
                "choose another loss."
            )
        importance = importance / normaliser
        black = loss.g(double_precision.float64()(0.0))
        squares = sum(add_up(array(importance) * dr.square(black - t)) for t in self.targets)
        self.scale = squares**0.5 or 1.0
        self.importance = importance / self.scale**2
        self.importances = [array(self.importance)] * self.channels
        dr.eval(self.targets, self.importances)

    def reweighted(self, weights):
        """The same problem, in which each sample counts `weights` (channels, n) times as much."""
        other = copy.copy(self)
        other.importances = [double_precision.array(self.importance * w) for w in weights]
        return other

    def lobes(self, values):
        """Two lists of one array (n,) per lobe, times κ: the factor of the weight, and that of the
        squared weight, which is None for a lobe without a quadratic term."""
        terms = self.model.bind(values).terms()
        plain = [self.cosines * lobe.eval(self.wi, self.wo) for _, lobe in terms]
        squared = [
            None if lobe.quadratic is None else self.cosines * lobe.quadratic(self.wi, self.wo)
            for _, lobe in terms
        ]
        return plain, squared

    def solve(self, values):
        """The best weights (channels, lobes) at `values`, which are numbers."""
        plain, squared = self.columns(values)
        return np.array([self._channel(plain, squared, c).solve() for c in range(self.channels)])

    def columns(self, values):
        """`lobes` as two NumPy arrays (lobes, n) at `values`, which are numbers; the second is None
        if no lobe has a quadratic term."""
        plain, squared = self.lobes(_bind(values))
        dr.eval(plain, squared)
        plain = np.stack([np.asarray(lobe) for lobe in plain])
        require_finite(self.model, plain, self.wi, self.wo)
        if all(lobe is None for lobe in squared):
            return plain, None
        none = np.zeros(plain.shape[1])
        return plain, np.stack([none if q is None else np.asarray(q) for q in squared])

    def residuals(self, values, weights):
        """Two lists by channel: residuals (n,), and their derivatives by the weights (lobes, n).

        The sum of the squared residuals is E², as long as the problem is not reweighted.
        """
        plain, squared = self.columns(values)
        root, residuals, derivatives = np.sqrt(self.importance), [], []
        for c, target in enumerate(self.targets):
            model, columns = self._channel(plain, squared, c).mix(weights[c])
            residuals.append(root * np.asarray(self.loss.g(model) - target))
            derivatives.append(columns * (root * np.asarray(self.loss.dg(model) + 0 * model)))
        return residuals, derivatives

    def _channel(self, plain, squared, c):
        return Channel(
            self.loss,
            plain,
            squared,
            self.measured[c],
            self.targets[c],
            self.importances[c],
            self.bounded,
        )

    def squared_error(self, values, weights):
        """E² at `values` and `weights` (channels, lobes)."""
        return add_up(self._squared_errors(_bind(values), weights))

    def squared_error_and_gradient(self, values, fixed, weights):
        """E² and its derivatives by `values`, with the shape parameters `fixed` and the `weights`
        (channels, lobes) held."""
        if not double_precision.differentiable():
            gradient = self._finite_differences(values, fixed, weights)
            return self.squared_error(values | fixed, weights), gradient
        bound = _bind(values | fixed)
        for name in values:
            dr.enable_grad(bound[name])
        total = dr.sum(self._squared_errors(bound, weights))
        dr.backward(total)
        gradient = np.array([to_float(dr.grad(bound[n])) for n in values])
        if not np.isfinite(gradient).all():
            require_finite_slopes(self.model, values | fixed, values, self.wi, self.wo)
        return to_float(dr.detach(total)), gradient

    def _squared_errors(self, bound, weights):
        """What each sample adds to E² (n,), as Dr.Jit; at values that `_bind` gave."""
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

    def _finite_differences(self, values, fixed, weights):
        """The derivatives of E² by `values`, for a backend that has none: central differences,
        one-sided at a bound."""
        gradient = []
        for name, value in values.items():
            low, high = self.model.parameters[name].bounds
            h = 1e-6 * max(abs(value), 1e-3)
            ends = max(value - h, low), min(value + h, high)
            below, above = (self.squared_error(values | fixed | {name: v}, weights) for v in ends)
            gradient.append((above - below) / (ends[1] - ends[0]))
        return np.array(gradient)


def _bind(values):
    """Numbers by name as Dr.Jit's."""
    return {name: double_precision.scalar(v) for name, v in values.items()}
