"""Defines `Objective`, the function that a solver minimises: the squared loss E² of one vector.

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
from brdfkit.regression.problem.parameter_space import join_point, make_point_limits, split_point
from brdfkit.regression.problem.problem import Problem


@dataclass(frozen=True, eq=False)
class End:
    """The result of a solver: the best point that it found, and why it stopped.

    Attributes
    ----------
    point : ndarray, shape (n,)
        The coordinates of the shape parameters, then the weights of the lobes by channel.
    error : float
        The squared loss E² at the point.
    message : str
        The reason why the solver stopped.
    """

    point: FloatArray
    error: float
    message: str = "converged"


class Objective:
    """The function that a solver minimises, the squared loss E² of a fit, with start points.

    A point (n,) contains the coordinates of the searched shape parameters, each from 0 to 1 between
    its bounds, then the weights of the lobes, channel by channel.

    Attributes
    ----------
    low, high : ndarray, shape (n,)
        The bounds of points; `high` is infinite for most weights.
    starts : ndarray, shape (count, n)
        Points that are spread over the bounds, the model's defaults first, with suitable weights.
    parts : tuple of Objective
        The objectives on growing parts of many samples; empty if there are few samples.
    constraints : Constraints, optional
        Functions of a point that should be at least 0: `values(z)` (m,), with derivatives
        `slopes(z)` (m, n).
    seed : int
        The seed of the fit, for a solver that draws random numbers.
    report : callable
        A function that shows progress, called with (number of steps done, number of all steps).
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
        self.best: tuple[float, FloatArray] | None = None  # (E², point) of the best point so far
        self.low, self.high = make_point_limits(
            self.shapes, problem.channels, problem.weight_limits
        )

    @classmethod
    def from_problems(cls, problems: Sequence[Any], *given: Any) -> Objective:
        """Return the objective of the last of the `problems`, with the ones before as its parts.

        The problems have growing numbers of samples; `given`: the arguments of the class after the
        problem.
        """
        *parts, whole = problems
        objective = cls(whole, *given)
        objective.parts = tuple(cls(part, *given) for part in parts)
        return objective

    @cached_property
    def starts(self) -> FloatArray:
        """The start points (count, n), with the best weights at their coordinates."""
        return self.join(self.coordinates, self.problem.estimate_weights(self.coordinates))

    def error(self, points: ArrayLike) -> FloatArray:
        """Return the squared loss (count,) at `points` (count, n) within the bounds."""
        return self.expand(points, curvature=False).error

    def expand(self, points: ArrayLike, curvature: bool = True) -> Expansion:
        """Return a quadratic approximation of the squared loss E² about `points` (count, n).

        The result has ``error``, E² (count,), ``gradient``, half the gradient of E² (count, n), and
        ``hessian``, half its Gauss-Newton Hessian (count, n, n). Without `curvature` it has no
        ``hessian``, which saves time.
        """
        points = np.array(points, float, ndmin=2)
        self.evaluations += len(points)
        expansion = self.problem.expand_at_weights(*self.split(points), curvature)
        best = int(np.argmin(expansion.error))
        if self.best is None or expansion.error[best] < self.best[0]:
            self.best = expansion.error[best], points[best]
        return expansion

    def clip(self, points: ArrayLike) -> FloatArray:
        """Return the points (count, n) within the bounds that are nearest to some points."""
        return np.clip(points, self.low, self.high)

    def split(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the two parts of points (count, n): coordinates and weights.

        Coordinates (count, shapes) belong to shape parameters, weights (count, channels, lobes) to
        the lobes of the model.
        """
        return split_point(points, self.shapes, self.problem.channels)

    def join(self, u: FloatArray, weights: FloatArray) -> FloatArray:
        """Return points (count, n) made of coordinates and weights, the inverse of `split`."""
        return join_point(u, weights)

    def count(self) -> int:
        """Return how often the squared loss was evaluated, on all samples and on parts of them."""
        return self.evaluations + sum(part.evaluations for part in self.parts)

    def require_end(self, end: Any) -> End:
        """Return the `End` that a user's solver returned, with its squared loss computed again.

        Raises `BrdfkitError` if it is no `End`, outside the bounds, or violates the constraints.
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
        """Return the best `End` so far of an interrupted search, or None if there is none.

        `ends`: expansion about the last points of the search, of which the best is returned. By
        default it is the best point evaluated on all samples, or on the largest part so far.
        """
        if ends is not None:
            best = ends.select_points([int(np.argmin(ends.error))])
            point = self.join(best.u, best.weights)[0]
        elif seen := [stage.best for stage in self.stages() if stage.best]:
            point = seen[-1][1]
        else:
            return None
        return End(point, float(self.error(point)[0]), "interrupted")

    def stages(self) -> tuple[Any, ...]:
        """Return the objectives on growing parts of the samples, and last this one on all."""
        return (*self.parts, self)


class Solver(Protocol):
    """The protocol of solvers, the algorithms that minimise the loss of a fit."""

    def minimise(self, objective: Objective) -> End:
        """Return the `End` with the least squared loss that the solver finds."""
