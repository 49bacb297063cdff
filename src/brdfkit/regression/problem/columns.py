"""Evaluates a model's lobes at pairs of directions, and their derivatives for its shape parameters.

A model is a weighted sum of lobes, M = Σ_l (a_l P_l + a_l² Q_l) + Σ_k R_k, with a weight a_l for
each lobe l. Only few lobes have a term Q_l with the squared weight, and only few models have lobes
R_k without a weight. All functions P_l, Q_l and R_k at some pairs of directions are the "values" of
the model. Their derivatives with respect to searched shape
parameters, such as a roughness, are its "slopes", without those that are always 0. Values and
slopes together are the "columns", one number for each pair of directions.
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
    """The list of columns of a model class, and the functions that evaluate them.

    The columns are the values of the model's lobes and their slopes, the derivatives with respect
    to shape parameters, as the file describes.

    `model`: the class; `names`: searched shape parameters; `fixed`: values of the other shape
    parameters, each a number or a Dr.Jit array; `lobes`: index of the lobe of each value; `powers`:
    power of the lobe's weight that multiplies each value, 1 or 2, or 0 for a lobe without a weight,
    whose index is 0; `slopes`: pairs (index of a value, index of a shape parameter).
    """

    model: type[Model]
    names: tuple[str, ...]
    fixed: dict[str, Any]
    lobes: np.ndarray
    powers: np.ndarray
    slopes: tuple[tuple[int, int], ...]

    @classmethod
    def for_model(
        cls, model: type[Model], names: Sequence[str], fixed: dict[str, float]
    ) -> Columns:
        """Return the columns of a `model` class.

        `names`: shape parameters that are searched; `fixed`: values of the others, by name.
        """
        key: Any = model
        traced = _trace_columns(key, tuple(names), tuple(sorted(fixed)))
        return cls(model, tuple(names), fixed, *traced)

    def __len__(self) -> int:
        return len(self.lobes) + len(self.slopes)

    def make_model(self, shapes: Sequence[JitFloat]) -> Model:
        """Return the model with the searched shape parameters `shapes`, an array or number each."""
        fixed = {
            name: double_precision.to_scalar(value) if isinstance(value, float) else value
            for name, value in self.fixed.items()
        }
        return self.model.bind(dict(zip(self.names, shapes, strict=True)) | fixed)

    def evaluate(
        self,
        shapes: Sequence[JitFloat],
        wi: Vector,
        wo: Vector,
        factor: Callable[[Lobe], JitFloat] | None = None,
    ) -> list[JitFloat]:
        """Return all columns, values and then slopes, as Dr.Jit arrays (n,).

        `shapes`: an array (n,) for each searched shape parameter; `wi`, `wo`: n incident and
        outgoing directions; `factor`: a function from a lobe to an array that replaces its value.
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
        """Return the values of the lobes as Dr.Jit arrays (n,), like `evaluate` without slopes."""
        model = self.make_model(shapes)
        lobes = [lobe for _, lobe in model.terms()]
        zeros = 0 * wi.z  # a constant lobe is one number; adding zeros makes it an array
        plain = [(factor(lobe) if factor else lobe.eval(wi, wo)) + zeros for lobe in lobes]
        squared = [lobe.quadratic(wi, wo) + zeros for lobe in lobes if lobe.quadratic]
        return plain + squared + [lobe.eval(wi, wo) + zeros for lobe in model.fixed_lobes()]

    def _difference_slopes(
        self, shapes: Sequence[JitFloat], wi: Vector, wo: Vector
    ) -> list[JitFloat]:
        """Return the slopes as Dr.Jit arrays (n,), by central differences of the values.

        Backends of Dr.Jit without automatic differentiation need it.
        """
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
    """Return the fields (lobes, powers, slopes) of `Columns` for a model class.

    They are found by an evaluation of the model at one pair of directions. `names`, `fixed`:
    searched and fixed shape parameters.
    """
    constants = {name: double_precision.to_scalar(model().values[name]) for name in fixed}
    up = double_precision.to_vector(np.array([[0.0, 0.0, 1.0]]))
    slopes, lobes, powers = [], [], []
    for j in range(-1, len(names)):
        shapes = {name: double_precision.to_scalar(model().values[name]) for name in names}
        if j >= 0:
            dr.enable_grad(shapes[names[j]])
        bound = model.bind(shapes | constants)
        terms, fixed_lobes = [lobe for _, lobe in bound.terms()], bound.fixed_lobes()
        values = [lobe.eval(up, up) for lobe in terms]
        values += [lobe.quadratic(up, up) for lobe in terms if lobe.quadratic]
        values += [lobe.eval(up, up) for lobe in fixed_lobes]
        if j < 0:
            lobes = [*range(len(terms)), *(k for k, lobe in enumerate(terms) if lobe.quadratic)]
            powers = [1] * len(terms) + [2] * (len(lobes) - len(terms)) + [0] * len(fixed_lobes)
            lobes += [0] * len(fixed_lobes)
        elif double_precision.has_derivatives():
            slopes += [(v, j) for v, value in enumerate(values) if dr.grad_enabled(value)]
        else:
            slopes += [(v, j) for v, value in enumerate(values) if not isinstance(value, float)]
    return np.array(lobes), np.array(powers), tuple(slopes)
