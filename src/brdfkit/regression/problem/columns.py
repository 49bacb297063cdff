"""The columns of a fit: a model's lobes at direction pairs, and their derivatives by its shapes.

With weights a, a model is M = Σ_l (a_l P_l + a_l² Q_l); few lobes have a Q. The values are the P,
then the Q; the slopes are the derivatives of values by searched shape parameters, where there are
any. Values, then slopes: these are the columns.
"""

from dataclasses import dataclass
from functools import cache

import drjit as dr
import numpy as np

from brdfkit.core.jit import double_precision


@dataclass(frozen=True)
class Columns:
    """The columns of a model class whose parameters `names` are searched and `fixed` are not.

    `lobes`, `powers`: of each value, the number of its lobe and the power of the weight, 1 or 2;
    `slopes`: (number of the value, number of the name) of each slope.
    """

    model: type
    names: tuple[str, ...]
    fixed: dict[str, float]
    lobes: np.ndarray
    powers: np.ndarray
    slopes: tuple[tuple[int, int], ...]

    @classmethod
    def of(cls, model, names, fixed):
        """The columns of the `model`; the parameters `fixed` have a value by name."""
        return cls(model, tuple(names), fixed, *_trace(model, tuple(names), tuple(sorted(fixed))))

    def __len__(self):
        return len(self.lobes) + len(self.slopes)

    def bind(self, shapes):
        """The model at `shapes`, one array or number for each name."""
        fixed = {name: double_precision.to_scalar(value) for name, value in self.fixed.items()}
        return self.model.bind(dict(zip(self.names, shapes, strict=True)) | fixed)

    def eval(self, shapes, wi, wo, factor=None):
        """Arrays (n,) of all columns, at `shapes`, one array (n,) for each name.

        `wi`, `wo`: `double_precision.Vector` of n directions. `factor(lobe)`: replaces the value of
        a lobe.
        """
        if not self.slopes:
            return self.values(shapes, wi, wo, factor)
        if not double_precision.has_derivatives():
            return self.values(shapes, wi, wo) + self._differences(shapes, wi, wo)
        for shape in shapes:
            dr.enable_grad(shape)
        values, slopes = self.values(shapes, wi, wo, factor), {}
        for j, shape in enumerate(shapes):
            dr.clear_grad(values)
            dr.set_grad(shape, 1)
            dr.enqueue(dr.ADMode.Forward, shape)
            dr.traverse(dr.ADMode.Forward, dr.ADFlag.ClearInterior)
            slopes |= {(v, k): dr.grad(values[v]) for v, k in self.slopes if k == j}
        return [dr.detach(value) for value in values] + [slopes[key] for key in self.slopes]

    def values(self, shapes, wi, wo, factor=None):
        """Arrays (n,) of the values alone; see `eval`."""
        lobes = [lobe for _, lobe in self.bind(shapes).terms()]
        none = 0 * wi.z  # a constant lobe is a number
        plain = [(factor(lobe) if factor else lobe.eval(wi, wo)) + none for lobe in lobes]
        return plain + [lobe.quadratic(wi, wo) + none for lobe in lobes if lobe.quadratic]

    def _differences(self, shapes, wi, wo):
        """The slopes by central differences, for a backend without derivatives."""
        slopes = {}
        for j, name in enumerate(self.names):
            low, high = self.model.parameters[name].bounds
            h = 1e-6 * dr.maximum(dr.abs(shapes[j]), 1e-3)
            ends = dr.maximum(shapes[j] - h, low), dr.minimum(shapes[j] + h, high)
            below, above = (
                self.values([*shapes[:j], end, *shapes[j + 1 :]], wi, wo) for end in ends
            )
            width = ends[1] - ends[0]
            slopes |= {(v, k): (above[v] - below[v]) / width for v, k in self.slopes if k == j}
        return [slopes[key] for key in self.slopes]


@cache
def _trace(model, names, fixed):
    """(lobes, powers, slopes) of `Columns`, found by evaluating the model at one direction pair."""
    constants = {name: double_precision.to_scalar(model().values[name]) for name in fixed}
    up = double_precision.to_vector(np.array([[0.0, 0.0, 1.0]]))
    slopes, lobes, powers = [], [], []
    for j in range(-1, len(names)):
        shapes = {name: double_precision.to_scalar(model().values[name]) for name in names}
        if j >= 0:
            dr.enable_grad(shapes[names[j]])
        terms = [lobe for _, lobe in model.bind(shapes | constants).terms()]
        values = [lobe.eval(up, up) for lobe in terms]
        values += [lobe.quadratic(up, up) for lobe in terms if lobe.quadratic]
        if j < 0:
            lobes = [*range(len(terms)), *(k for k, lobe in enumerate(terms) if lobe.quadratic)]
            powers = [1] * len(terms) + [2] * (len(lobes) - len(terms))
        elif double_precision.has_derivatives():
            slopes += [(v, j) for v, value in enumerate(values) if dr.grad_enabled(value)]
        else:
            slopes += [(v, j) for v, value in enumerate(values) if not isinstance(value, float)]
    return np.array(lobes), np.array(powers), tuple(slopes)
