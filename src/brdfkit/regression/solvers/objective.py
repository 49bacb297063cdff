"""`Objective`, what a solver is given: E² of a model on samples, as a function of one vector.

A point z (n,) holds the coordinates of the searched shape parameters, each from 0 to 1 within its
bounds, then the weights of the first channel, of the second and so on.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from brdfkit.core.errors import BrdfkitError
from brdfkit.regression.problem.expansion import Expansion
from brdfkit.regression.problem.parameter_space import join, limits, split

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class End:
    """The result of a search: the best point, and why the search stopped.

    Attributes
    ----------
    point : ndarray, shape (n,)
        The point z.
    error : float
        E² there.
    message : str
        Why the search stopped.
    """

    point: Floats
    error: float
    message: str = "converged"


class Objective:
    """E² at points z, and where a search may begin.

    Attributes
    ----------
    low, high : ndarray, shape (n,)
        The bounds of z; `high` is infinite for weights.
    starts : ndarray, shape (count, n)
        Points that are spread over the bounds, the model's defaults first, with weights that suit.
    parts : tuple of Objective
        The same on ever larger parts of many samples; empty where there are few.
    constraints : Constraints, optional
        Functions of z that shall not be negative: their `values` (m,) and `slopes` (m, n).
    seed : int
        The seed of the fit, for a solver that draws random numbers.
    report : callable
        Called with (steps done, steps in all).
    evaluations : int
        At how many points E² was computed so far.
    """

    def __init__(self, problem, coordinates, seed, report, constraints=None, parts=()):
        self.problem, self.coordinates = problem, coordinates
        self.seed, self.report = seed, report
        self.constraints, self.parts = constraints, parts
        self.shapes, self.evaluations = coordinates.shape[1], 0
        self.best = None  # (E², point) of all that were evaluated
        self.low, self.high = limits(self.shapes, problem.channels, problem.least)

    @classmethod
    def of(cls, problems, *given):
        """The objective of the last of the `problems` on ever more samples; the others are its
        parts. `given`: the other arguments."""
        *parts, whole = problems
        return cls(whole, *given, parts=tuple(cls(part, *given) for part in parts))

    @cached_property
    def starts(self) -> Floats:
        return self.join(self.coordinates, self.problem.start(self.coordinates))

    def error(self, points: ArrayLike) -> Floats:
        """E² (count,) at `points` (count, n) within the bounds, all of them in one kernel."""
        return self.expand(points, curvature=False).error

    def expand(self, points: ArrayLike, curvature: bool = True) -> Expansion:
        """E² about `points` (count, n) to second order: ``error`` (count,), ``gradient`` (count, n)
        and, unless `curvature` is False, ``hessian`` (count, n, n), by Gauss and Newton; the
        derivatives are halves of those of E²."""
        points = np.array(points, float, ndmin=2)
        self.evaluations += len(points)
        found = self.problem.expand_here(*self.split(points), curvature)
        best = int(np.argmin(found.error))
        if self.best is None or found.error[best] < self.best[0]:
            self.best = found.error[best], points[best]
        return found

    def clip(self, points: ArrayLike) -> Floats:
        """The nearest points within the bounds."""
        return np.clip(points, self.low, self.high)

    def split(self, points: Floats) -> tuple[Floats, Floats]:
        """Coordinates (count, shapes) and weights (count, channels, lobes) of points (count, n)."""
        return split(points, self.shapes, self.problem.channels)

    def join(self, u: Floats, weights: Floats) -> Floats:
        """The points of coordinates and weights."""
        return join(u, weights)

    def count(self) -> int:
        """The evaluations on all samples and on parts of them."""
        return self.evaluations + sum(part.evaluations for part in self.parts)

    def require_end(self, end: Any) -> End:
        """What a user's solver returned, if it is an `End` within the bounds that meets the
        constraints, with E² computed here, or `BrdfkitError`."""
        inside = isinstance(end, End) and np.shape(end.point) == self.low.shape
        if not (inside and np.all((self.low <= end.point) & (end.point <= self.high))):
            raise BrdfkitError(
                f"The solver returned {end!r:.200}; it should return an End, whose point has "
                f"{len(self.low)} finite numbers within objective.low and objective.high."
            )
        point = np.array(end.point, float)
        if not np.isfinite(point).all():
            raise BrdfkitError("The solver returned an End whose point is not finite.")
        if self.constraints and not self.constraints.met(point):
            raise BrdfkitError("The solver returned an End that does not meet the constraints.")
        sums = self.problem.expand_here(*self.split(point[None]), curvature=False)
        return End(point, float(sums.error[0]), str(end.message))

    def best_so_far(self, ends: Expansion | None = None) -> End | None:
        """The `End` of an interrupted search, which had come to the points `ends`, or, by default,
        evaluated some on the most samples; None where there are none."""
        if ends is not None:
            best = ends.at([int(np.argmin(ends.error))])
            point = self.join(best.u, best.weights)[0]
        elif seen := [stage.best for stage in self.stages() if stage.best]:
            point = seen[-1][1]
        else:
            return None
        return End(point, float(self.error(point)[0]), "interrupted")

    def stages(self) -> tuple[Any, ...]:
        """The objectives of a search on ever more samples: the parts, then this one."""
        return (*self.parts, self)


class Solver(Protocol):
    """What finds the end of a fit's search."""

    def minimise(self, objective: Objective) -> End:
        """The end with the least E² that it finds."""
