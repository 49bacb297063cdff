"""Evaluates the lobes of a model at pairs of directions, and their derivatives by its shapes.

With weights a, a model is M = Σ_l (a_l P_l + a_l² Q_l), where few lobes l have a Q. The "columns"
of a fit are its values and its slopes: values are all P, then all Q; slopes are the derivatives of
values by searched shape parameters, unless they are always 0.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.array_types import IntArray, JitFloat
from brdfkit.core.jit import double_precision
from brdfkit.core.jit.double_precision import Vector
from brdfkit.model import Model
from brdfkit.model.lobes import Lobe


@dataclass(frozen=True)
class Columns:
    """The columns of a model class: `names` are searched shape parameters, `fixed` the others.

    `lobes`, `powers`: for each value the index of its lobe, and the power of its weight, 1 or 2;
    `slopes`: (index of the value, index of the name) for each slope.
    """

    model: type[Model]
    names: tuple[str, ...]
    fixed: dict[str, float]
    lobes: np.ndarray
    powers: np.ndarray
    slopes: tuple[tuple[int, int], ...]

    @classmethod
    def for_model(
        cls, model: type[Model], names: Sequence[str], fixed: dict[str, float]
    ) -> Columns:
        """Return the columns of a `model` class; `fixed`: values by the parameters' names."""
        key: Any = model
        traced = _trace_columns(key, tuple(names), tuple(sorted(fixed)))
        return cls(model, tuple(names), fixed, *traced)

    def __len__(self) -> int:
        return len(self.lobes) + len(self.slopes)

    def make_model(self, shapes: Sequence[JitFloat]) -> Model:
        """Return the model with `shapes`, one array or number for each name."""
        fixed = {name: double_precision.to_scalar(value) for name, value in self.fixed.items()}
        return self.model.bind(dict(zip(self.names, shapes, strict=True)) | fixed)

    def evaluate(
        self,
        shapes: Sequence[JitFloat],
        wi: Vector,
        wo: Vector,
        factor: Callable[[Lobe], JitFloat] | None = None,
    ) -> list[JitFloat]:
        """Evaluate all columns at `shapes`, one array (n,) for each name; return arrays (n,).

        `wi`, `wo`: n directions, each a `double_precision.Vector`; `factor(lobe)`: replaces the
        value of a lobe.
        """
        if not self.slopes:
            return self.evaluate_values(shapes, wi, wo, factor)
        if not double_precision.has_derivatives():
            return self.evaluate_values(shapes, wi, wo) + self._difference_slopes(shapes, wi, wo)
        for shape in shapes:
            dr.enable_grad(shape)
        values = self.evaluate_values(shapes, wi, wo, factor)
        slopes: dict[tuple[int, int], JitFloat] = {}
        for j, shape in enumerate(shapes):
            dr.clear_grad(values)
            dr.set_grad(shape, 1)
            dr.enqueue(dr.ADMode.Forward, shape)
            dr.traverse(dr.ADMode.Forward, dr.ADFlag.ClearInterior)
            slopes |= {(v, k): dr.grad(values[v]) for v, k in self.slopes if k == j}
        return [dr.detach(value) for value in values] + [slopes[key] for key in self.slopes]

    def evaluate_values(
        self,
        shapes: Sequence[JitFloat],
        wi: Vector,
        wo: Vector,
        factor: Callable[[Lobe], JitFloat] | None = None,
    ) -> list[JitFloat]:
        """Evaluate only the values, and return arrays (n,); see `evaluate`."""
        lobes = [lobe for _, lobe in self.make_model(shapes).terms()]
        zeros = 0 * wi.z  # makes an array of a constant lobe
        plain = [(factor(lobe) if factor else lobe.eval(wi, wo)) + zeros for lobe in lobes]
        return plain + [lobe.quadratic(wi, wo) + zeros for lobe in lobes if lobe.quadratic]

    def _difference_slopes(
        self, shapes: Sequence[JitFloat], wi: Vector, wo: Vector
    ) -> list[JitFloat]:
        """Return the slopes by central differences, for a backend without derivatives."""
        slopes: dict[tuple[int, int], JitFloat] = {}
        for j, name in enumerate(self.names):
            low, high = self.model.parameters[name].bounds
            h = 1e-6 * dr.maximum(dr.abs(shapes[j]), 1e-3)
            ends = dr.maximum(shapes[j] - h, low), dr.minimum(shapes[j] + h, high)
            below, above = (
                self.evaluate_values([*shapes[:j], end, *shapes[j + 1 :]], wi, wo) for end in ends
            )
            width = ends[1] - ends[0]
            slopes |= {(v, k): (above[v] - below[v]) / width for v, k in self.slopes if k == j}
        return [slopes[key] for key in self.slopes]


@cache
def _trace_columns(
    model: Any, names: tuple[str, ...], fixed: tuple[str, ...]
) -> tuple[IntArray, IntArray, tuple[tuple[int, int], ...]]:
    """Return (lobes, powers, slopes) of `Columns`, from the model at one pair of directions."""
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
