"""The constraints of a fit: what its parameters have to meet, beside their bounds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from brdfkit.core.arguments import to_positive
from brdfkit.core.errors import BrdfkitError
from brdfkit.model.evaluation import make_model
from brdfkit.regression.problem.parameter_space import join, limits, split

# Constraints are met to the first, and active where they have less than the second to spare
MET, ACTIVE = 1e-8, 1e-6
# Step of the differences of a user's function
SMALL = 1e-5


@dataclass(frozen=True)
class WeightsAtMost:
    """A constraint: in each channel the weights add up to `limit` at most, as k_d + k_s ≤ 1.

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
        object.__setattr__(self, "limit", to_positive("WeightsAtMost: limit", self.limit))

    def values(self, problem, u, weights):
        """The values (m,) at a point, not negative where the constraint is met."""
        return self.limit - weights[0].sum(axis=1)

    def slopes(self, problem, u, weights):
        """Their derivatives (m, n) by coordinates, then by weights."""
        _, channels, lobes = weights.shape
        by_weights = np.kron(np.eye(channels), np.ones(lobes))
        return np.hstack([np.zeros((channels, u.shape[1])), -by_weights])

    def describe(self, rows, channels):
        """What the values of these numbers limit, in words."""
        return "the sum of the weights"


class Custom:
    """A user's function of a model with its values, not negative where it is met."""

    def __init__(self, function):
        self.function = function

    def values(self, problem, u, weights):
        """As `WeightsAtMost.values`."""
        return self._values(problem, join(u, weights)[0])

    def slopes(self, problem, u, weights):
        """As `WeightsAtMost.slopes`, by central differences."""
        z = join(u, weights)[0]
        low, high = limits(u.shape[1], problem.channels, problem.least)
        slopes = []
        for k in range(len(z)):
            below, above = z.copy(), z.copy()
            step = SMALL * max(1.0, abs(z[k]))
            below[k], above[k] = max(z[k] - step, low[k]), min(z[k] + step, high[k])
            change = self._values(problem, above) - self._values(problem, below)
            slopes.append(change / (above[k] - below[k]))
        return np.stack(slopes, axis=1)

    def _values(self, problem, z):
        u, weights = split(z[None], len(problem.space.names), problem.channels)
        shown = make_model(problem.columns.model, problem.space.values(u[0]), weights[0])
        try:
            found = self.function(shown)
        except Exception as error:
            raise BrdfkitError(
                f"{self.describe([], 0)} fails with {type(error).__name__} ({error}); it is called "
                "with the model and its values."
            ) from error
        try:
            values = np.array(found, float).ravel()
        except (TypeError, ValueError):
            values = np.array([np.nan])
        if not np.isfinite(values).all():
            raise BrdfkitError(
                f"{self.describe([], 0)} returned {found!r}; it should return a finite number, or "
                "several, that are not negative where the model meets it."
            )
        return values

    def describe(self, rows, channels):
        """As `WeightsAtMost.describe`."""
        return f"the constraint {getattr(self.function, '__name__', repr(self.function))}"


class Constraints:
    """All constraints of a fit, as one vector of values that shall not be negative."""

    def __init__(self, constraints, problem):
        self.each = [c if hasattr(c, "slopes") else Custom(c) for c in constraints]
        self.problem = problem

    def values(self, z: Any) -> Any:
        """The values (m,) at a point z (n,)."""
        return np.concatenate([c.values(self.problem, *self._split(z)) for c in self.each])

    def slopes(self, z: Any) -> Any:
        """Their derivatives (m, n)."""
        return np.concatenate([c.slopes(self.problem, *self._split(z)) for c in self.each])

    def met(self, z):
        """Whether a point meets all constraints."""
        return bool((self.values(z) >= -MET).all())

    def keep_met(self, ends):
        """Those of the `ends` that meet all constraints; an error where none does."""
        met = [end for end in ends if self.met(end.point)]
        if not met:
            nearest = max((end.point for end in ends), key=lambda z: self.values(z).min())
            broken = " and ".join(self._describe(nearest, -MET))
            raise BrdfkitError(
                f"{self.problem.model.type_name()}: no parameters were found that meet the "
                f"constraints: {broken} stays beyond the limit; loosen it, or take another model."
            )
        return met

    def notes(self, z):
        """Which constraints are active, in sentences."""
        return tuple(
            f"{what} is at its limit, which standard errors and intervals do not know of"
            for what in self._describe(z, ACTIVE)
        )

    def _describe(self, z, spare):
        """What has less than so much to spare."""
        found = []
        for constraint in self.each:
            (rows,) = np.nonzero(constraint.values(self.problem, *self._split(z)) < spare)
            if len(rows):
                found.append(constraint.describe(rows, self.problem.channels))
        return found

    def _split(self, z):
        """Coordinates (1, shapes) and weights (1, channels, lobes) of a point."""
        return split(z[None], len(self.problem.space.names), self.problem.channels)
