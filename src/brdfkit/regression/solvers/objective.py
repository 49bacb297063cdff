"""`Objective`: the function that a solver minimises, E² of a model on samples by one vector.

A point z (n,) has the coordinates of the searched shape parameters, each from 0 to 1 between its
bounds, then the weights of the first channel, of the second and so on.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike

from brdfkit.core.array_types import FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.progress_bar import Progress
from brdfkit.regression.problem.expansion import Expansion
from brdfkit.regression.problem.parameter_space import join_point, make_limits, split_point
from brdfkit.regression.problem.problem import Problem


@dataclass(frozen=True, eq=False)
class End:
    """The result of a search: the best point, and why the search stopped.

    Attributes
    ----------
    point : ndarray, shape (n,)
        The point z.
    error : float
        E² at the point.
    message : str
        Why the search stopped.
    """

    point: FloatArray
    error: float
    message: str = "converged"


class Objective:
    """E² at points z, with bounds and start points.

    Attributes
    ----------
    low, high : ndarray, shape (n,)
        The bounds of z; `high` is infinite for weights.
    starts : ndarray, shape (count, n)
        Points that are spread over the bounds, the model's defaults first, with suitable weights.
    parts : tuple of Objective
        The objectives on ever larger parts of many samples; empty if there are few.
    constraints : Constraints, optional
        Functions of z that must be at least 0: `values(z)` (m,) and `slopes(z)` (m, n).
    seed : int
        The seed of the fit, for a solver that draws random numbers.
    report : callable
        Called with (number of steps done, number of all steps).
    evaluations : int
        The number of points at which E² was computed so far.
    """

    def __init__(
        self,
        problem: Problem,
        coordinates: FloatArray,
        seed: int,
        report: Progress,
        constraints: Any = None,
        parts: tuple[Objective, ...] = (),
    ) -> None:
        self.problem, self.coordinates = problem, coordinates
        self.seed, self.report = seed, report
        self.constraints, self.parts = constraints, parts
        self.shapes, self.evaluations = coordinates.shape[1], 0
        self.best: tuple[float, FloatArray] | None = None  # (E², point) with the least E² so far
        self.low, self.high = make_limits(self.shapes, problem.channels, problem.least)

    @classmethod
    def of(cls, problems: Sequence[Any], *given: Any) -> Objective:
        """Return the objective of the last of the `problems`, with the others as its parts.

        The `problems` are on ever more samples; `given`: the other arguments.
        """
        *parts, whole = problems
        objective = cls(whole, *given)
        objective.parts = tuple(cls(part, *given) for part in parts)
        return objective

    @cached_property
    def starts(self) -> FloatArray:
        return self.join(self.coordinates, self.problem.estimate_weights(self.coordinates))

    def error(self, points: ArrayLike) -> FloatArray:
        """Return E² (count,) at `points` (count, n) within the bounds, all in one kernel."""
        return self.expand(points, curvature=False).error

    def expand(self, points: ArrayLike, curvature: bool = True) -> Expansion:
        """Return E² about `points` (count, n) to second order, by Gauss and Newton.

        The result has ``error`` (count,), ``gradient`` (count, n) and, unless `curvature` is False,
        ``hessian`` (count, n, n). The derivatives are half the derivatives of E².
        """
        points = np.array(points, float, ndmin=2)
        self.evaluations += len(points)
        expansion = self.problem.expand_at_weights(*self.split(points), curvature)
        best = int(np.argmin(expansion.error))
        if self.best is None or expansion.error[best] < self.best[0]:
            self.best = expansion.error[best], points[best]
        return expansion

    def clip(self, points: ArrayLike) -> FloatArray:
        """Return the nearest points within the bounds."""
        return np.clip(points, self.low, self.high)

    def split(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return coordinates (count, shapes) and weights (count, channels, lobes) of points."""
        return split_point(points, self.shapes, self.problem.channels)

    def join(self, u: FloatArray, weights: FloatArray) -> FloatArray:
        """Return the points (count, n) of coordinates and weights."""
        return join_point(u, weights)

    def count(self) -> int:
        """Return the number of evaluations, on all samples and on parts of them."""
        return self.evaluations + sum(part.evaluations for part in self.parts)

    def require_end(self, end: Any) -> End:
        """Return the `End` that a user's solver returned, with E² computed again.

        Raises `BrdfkitError` if it is no `End` within the bounds that meets the constraints.
        """
        inside = isinstance(end, End) and np.shape(end.point) == self.low.shape
        if not (inside and np.all((self.low <= end.point) & (end.point <= self.high))):
            raise BrdfkitError(
                f"The solver returned {end!r:.200}; it should return an End, whose point has "
                f"{len(self.low)} finite numbers within objective.low and objective.high."
            )
        point = np.array(end.point, float)
        if not np.isfinite(point).all():
            raise BrdfkitError("The solver returned an End whose point is not finite.")
        if self.constraints and not self.constraints.are_met(point):
            raise BrdfkitError("The solver returned an End that does not meet the constraints.")
        sums = self.problem.expand_at_weights(*self.split(point[None]), curvature=False)
        return End(point, float(sums.error[0]), str(end.message))

    def best_so_far(self, ends: Expansion | None = None) -> End | None:
        """Return the best `End` of an interrupted search, None without any.

        `ends`: an `Expansion` about the last points; by default the points evaluated so far, on as
        many samples as possible.
        """
        if ends is not None:
            best = ends.select([int(np.argmin(ends.error))])
            point = self.join(best.u, best.weights)[0]
        elif seen := [stage.best for stage in self.stages() if stage.best]:
            point = seen[-1][1]
        else:
            return None
        return End(point, float(self.error(point)[0]), "interrupted")

    def stages(self) -> tuple[Any, ...]:
        """Return the objectives of a search on ever more samples: the parts, then this one."""
        return (*self.parts, self)


class Solver(Protocol):
    """An algorithm that minimises the loss of a fit."""

    def minimise(self, objective: Objective) -> End:
        """Return the end with the least E² that it finds."""
