"""Defines constraints, which the parameters of a fit have to meet in addition to their bounds.

A constraint returns values that are at least 0 where it is met, and their derivatives. A point is
given by coordinates `u` (1, shapes) of the shape parameters and weights (1, channels, lobes) of the
lobes, or by a vector z (n,) of both.
"""

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
from brdfkit.regression.problem.parameter_space import join_point, make_point_limits, split_point
from brdfkit.regression.problem.problem import Problem
from brdfkit.regression.solvers.objective import End

# A constraint counts as met even if its value is below 0 by as much as this
MET_TOLERANCE = 1e-8
# A constraint counts as active, at its limit, if its value is below this number
ACTIVE_TOLERANCE = 1e-6
# Step of the finite differences that give the derivatives of a user's constraint
DIFFERENCE_STEP = 1e-5


@dataclass(frozen=True)
class WeightsAtMost:
    """A constraint of a fit: the sum of the lobes' weights is limited, as in k_d + k_s ≤ 1.

    Parameters
    ----------
    limit : float, default 1
        The largest sum of the weights in each channel, above 0.

    Examples
    --------
    >>> fit("paint.binary", "ward", constraints=[WeightsAtMost(1.0)])    # doctest: +SKIP
    """

    limit: float = 1.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "limit", to_positive_number("WeightsAtMost: limit", self.limit))

    def values(self, problem: Problem, u: FloatArray, weights: FloatArray) -> FloatArray:
        """Return the limit less the sum of the weights in each channel, (channels,).

        `weights` (1, channels, lobes): weights of the lobes. The limit is met where the values are
        at least 0.
        """
        return self.limit - weights[0].sum(axis=1)

    def slopes(self, problem: Problem, u: FloatArray, weights: FloatArray) -> FloatArray:
        """Return the derivatives (channels, n) of `values` by the n coordinates and weights."""
        _, channels, lobes = weights.shape
        by_weights = np.kron(np.eye(channels), np.ones(lobes))
        return np.hstack([np.zeros((channels, u.shape[1])), -by_weights])

    def describe(self, rows: IntArray, channels: int) -> str:
        """Return in words what the constraint limits; the arguments have no effect."""
        return "the sum of the weights"


class UserConstraint:
    """A constraint of a fit given as a user's function of the model.

    The function takes the `Model` and returns one or several numbers, which are at least 0 where
    the constraint is met.
    """

    def __init__(self, function: Callable[[Model], Any]) -> None:
        self.function = function

    def values(self, problem: Problem, u: FloatArray, weights: FloatArray) -> FloatArray:
        """Return the numbers (m,) that the user's function returns for the model at a point."""
        return self._call_user_function(problem, join_point(u, weights)[0])

    def slopes(self, problem: Problem, u: FloatArray, weights: FloatArray) -> FloatArray:
        """Return the derivatives (m, n) for the parameters, from central differences."""
        z = join_point(u, weights)[0]
        low, high = make_point_limits(u.shape[1], problem.channels, problem.weight_limits)
        slopes = []
        for k in range(len(z)):
            below, above = z.copy(), z.copy()
            step = DIFFERENCE_STEP * max(1.0, abs(z[k]))
            below[k], above[k] = max(z[k] - step, low[k]), min(z[k] + step, high[k])
            change = self._call_user_function(problem, above) - self._call_user_function(
                problem, below
            )
            slopes.append(change / (above[k] - below[k]))
        return np.stack(slopes, axis=1)

    def _call_user_function(self, problem: Problem, z: FloatArray) -> FloatArray:
        """Return the numbers (m,) of the function for the model at a point z (n,).

        Raises `BrdfkitError` if the function fails or returns something else.
        """
        u, weights = split_point(z[None], len(problem.space.names), problem.channels)
        model = make_model(problem.columns.model, problem.space.to_named_values(u[0]), weights[0])
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
        """Return the constraint in words, by the name of the function."""
        return f"the constraint {getattr(self.function, '__name__', repr(self.function))}"


class Constraints:
    """The constraints of a fit, evaluated as one vector of values that should be at least 0.

    The methods take points z (n,): coordinates of the shape parameters, then the lobes' weights.
    """

    def __init__(self, constraints: Iterable[Any], problem: Problem) -> None:
        self.each = [c if hasattr(c, "slopes") else UserConstraint(c) for c in constraints]
        self.problem = problem

    def values(self, z: Any) -> Any:
        """Return the values (m,) of all constraints at a point z, at least 0 where they are met."""
        return np.concatenate([c.values(self.problem, *self._split_point(z)) for c in self.each])

    def slopes(self, z: Any) -> Any:
        """Return the constraints' derivatives (m, n) with respect to the entries of a point z."""
        return np.concatenate([c.slopes(self.problem, *self._split_point(z)) for c in self.each])

    def are_met(self, z: FloatArray) -> bool:
        """Return whether a point z meets all constraints, up to rounding errors."""
        return bool((self.values(z) >= -MET_TOLERANCE).all())

    def keep_valid_ends(self, ends: list[End]) -> list[End]:
        """Return those ends of searches that meet all constraints; raise an error if none does."""
        met = [end for end in ends if self.are_met(end.point)]
        if not met:
            nearest = max((end.point for end in ends), key=lambda z: self.values(z).min())
            broken = " and ".join(self._describe_values_below(nearest, -MET_TOLERANCE))
            raise BrdfkitError(
                f"{self.problem.model.type_name()}: no parameters were found that meet the "
                f"constraints: {broken} stays beyond the limit; loosen it, or take another model."
            )
        return met

    def write_notes(self, z: FloatArray) -> tuple[str, ...]:
        """Return a sentence on each constraint that is at its limit at a point z, for a fit."""
        return tuple(
            f"{quantity} is at its limit, which standard errors and intervals do not know of"
            for quantity in self._describe_values_below(z, ACTIVE_TOLERANCE)
        )

    def _describe_values_below(self, z: FloatArray, limit: float) -> list[str]:
        """Return in words what the constraints limit whose values at z are below `limit`."""
        quantities = []
        for constraint in self.each:
            (rows,) = np.nonzero(constraint.values(self.problem, *self._split_point(z)) < limit)
            if len(rows):
                quantities.append(constraint.describe(rows, self.problem.channels))
        return quantities

    def _split_point(self, z: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the coordinates (1, shapes) and weights (1, channels, lobes) of a point z."""
        return split_point(z[None], len(self.problem.space.names), self.problem.channels)
