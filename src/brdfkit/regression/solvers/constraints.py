"""The constraints of a fit, which its parameters have to meet beside their bounds."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from brdfkit.core.arguments import to_positive_number
from brdfkit.core.array_types import FloatArray, IntArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.model import Model
from brdfkit.model.evaluation import make_model
from brdfkit.regression.problem.parameter_space import join_point, make_limits, split_point
from brdfkit.regression.problem.problem import Problem
from brdfkit.regression.solvers.objective import End

# A constraint is met if its value is above minus the first, and active if it is below the second
MET_TOLERANCE, ACTIVE_TOLERANCE = 1e-8, 1e-6
# Step of the differences of a user's function
DIFFERENCE_STEP = 1e-5


@dataclass(frozen=True)
class WeightsAtMost:
    """A constraint: in each channel the sum of the weights is at most `limit`, as k_d + k_s ≤ 1.

    Parameters
    ----------
    limit : float, default 1
        The largest sum of a channel's weights, above 0.

    Examples
    --------
    >>> fit("paint.binary", "ward", constraints=[WeightsAtMost(1.0)])    # doctest: +SKIP
    """

    limit: float = 1.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "limit", to_positive_number("WeightsAtMost: limit", self.limit))

    def values(self, problem: Problem, u: FloatArray, weights: FloatArray) -> FloatArray:
        """Return the values (m,) at a point, at least 0 where the constraint is met."""
        return self.limit - weights[0].sum(axis=1)

    def slopes(self, problem: Problem, u: FloatArray, weights: FloatArray) -> FloatArray:
        """Return the derivatives (m, n) of `values` by coordinates, then by weights."""
        _, channels, lobes = weights.shape
        by_weights = np.kron(np.eye(channels), np.ones(lobes))
        return np.hstack([np.zeros((channels, u.shape[1])), -by_weights])

    def describe(self, rows: IntArray, channels: int) -> str:
        """Return what the values with the indices `rows` limit, in words."""
        return "the sum of the weights"


class UserConstraint:
    """A user's function of a model, which returns numbers ≥ 0 where the constraint is met."""

    def __init__(self, function: Callable[[Model], Any]) -> None:
        self.function = function

    def values(self, problem: Problem, u: FloatArray, weights: FloatArray) -> FloatArray:
        """Return the values (m,) at a point."""
        return self._call(problem, join_point(u, weights)[0])

    def slopes(self, problem: Problem, u: FloatArray, weights: FloatArray) -> FloatArray:
        """Return the derivatives (m, n) of the values by central differences."""
        z = join_point(u, weights)[0]
        low, high = make_limits(u.shape[1], problem.channels, problem.least)
        slopes = []
        for k in range(len(z)):
            below, above = z.copy(), z.copy()
            step = DIFFERENCE_STEP * max(1.0, abs(z[k]))
            below[k], above[k] = max(z[k] - step, low[k]), min(z[k] + step, high[k])
            change = self._call(problem, above) - self._call(problem, below)
            slopes.append(change / (above[k] - below[k]))
        return np.stack(slopes, axis=1)

    def _call(self, problem: Problem, z: FloatArray) -> FloatArray:
        """Call the function at a point z (n,); raise `BrdfkitError` if it fails."""
        u, weights = split_point(z[None], len(problem.space.names), problem.channels)
        model = make_model(problem.columns.model, problem.space.to_values(u[0]), weights[0])
        try:
            returned = self.function(model)
        except Exception as error:
            raise BrdfkitError(
                f"{self.describe()} fails with {type(error).__name__} ({error}); it is called "
                "with the model and its values."
            ) from error
        try:
            values = np.array(returned, float).ravel()
        except (TypeError, ValueError):
            values = np.array([np.nan])
        if not np.isfinite(values).all():
            raise BrdfkitError(
                f"{self.describe()} returned {returned!r}; it should return a finite number, "
                "or several, that are not negative where the model meets it."
            )
        return values

    def describe(self, *_: Any) -> str:
        """Return the name of the function."""
        return f"the constraint {getattr(self.function, '__name__', repr(self.function))}"


class Constraints:
    """All constraints of a fit, as one vector of values that must be at least 0."""

    def __init__(self, constraints: Iterable[Any], problem: Problem) -> None:
        self.each = [c if hasattr(c, "slopes") else UserConstraint(c) for c in constraints]
        self.problem = problem

    def values(self, z: Any) -> Any:
        """Return the values (m,) at a point z (n,)."""
        return np.concatenate([c.values(self.problem, *self._split(z)) for c in self.each])

    def slopes(self, z: Any) -> Any:
        """Return the derivatives (m, n) of the values at a point z (n,)."""
        return np.concatenate([c.slopes(self.problem, *self._split(z)) for c in self.each])

    def are_met(self, z: FloatArray) -> bool:
        """Return whether a point z (n,) meets all constraints."""
        return bool((self.values(z) >= -MET_TOLERANCE).all())

    def select_met(self, ends: list[End]) -> list[End]:
        """Return the `ends` that meet all constraints; raise `BrdfkitError` if none does."""
        met = [end for end in ends if self.are_met(end.point)]
        if not met:
            nearest = max((end.point for end in ends), key=lambda z: self.values(z).min())
            broken = " and ".join(self._describe(nearest, -MET_TOLERANCE))
            raise BrdfkitError(
                f"{self.problem.model.type_name()}: no parameters were found that meet the "
                f"constraints: {broken} stays beyond the limit; loosen it, or take another model."
            )
        return met

    def notes(self, z: FloatArray) -> tuple[str, ...]:
        """Return a sentence on each constraint that is active at a point z (n,)."""
        return tuple(
            f"{quantity} is at its limit, which standard errors and intervals do not know of"
            for quantity in self._describe(z, ACTIVE_TOLERANCE)
        )

    def _describe(self, z: FloatArray, limit: float) -> list[str]:
        """Return what the constraints with values below `limit` restrict, in words."""
        quantities = []
        for constraint in self.each:
            (rows,) = np.nonzero(constraint.values(self.problem, *self._split(z)) < limit)
            if len(rows):
                quantities.append(constraint.describe(rows, self.problem.channels))
        return quantities

    def _split(self, z: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return coordinates (1, shapes) and weights (1, channels, lobes) of a point z (n,)."""
        return split_point(z[None], len(self.problem.space.names), self.problem.channels)
