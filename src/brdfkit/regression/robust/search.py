"""Searches for the fixed point of reweighting, the solution of a robust fit.

At the fixed point, parameters are fitted with weights of the samples that the residuals of these
parameters reproduce. A pass computes the weights from the residuals, then takes one step towards
the best parameters for these weights. With few samples, the first passes are those of MATLAB's
robustfit, which solves for the parameters with constant weights. They become slow if much of a
highlight is an outlier. Then Newton's steps replace them, which include the change of the weights:
far from the end they reduce a merit at constant scales of the noise; near the end they solve for
the point where an ordinary pass changes nothing, including the change of the scales.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.interrupts import Interrupted
from brdfkit.core.progress_bar import Progress
from brdfkit.regression.problem.problem import Problem
from brdfkit.regression.problem.subset import draw_subset
from brdfkit.regression.robust.problem import Point, RobustProblem

# Newton's steps are longer than ordinary ones by at most 1 / this factor, in each direction
SMALLEST_CURVATURE = 0.02
PASSES = 150
# With more samples, the search starts on half as many
MANY_SAMPLES = 80_000
# The passes have settled if the next one would change the fitted values by this share of their
# spread (rms)
SETTLED = 3e-7
# Few samples settle to this share
EXACT = 1e-11
# A part, whose end is only a start, settles to this share
LOOSE = 1e-5
# If a pass changes the fitted values by a smaller share, the end is near
NEAR_END = 1e-3
# If a step to the end leaves a larger share of the change, the Hessian of a part is too rough
SLOW = 0.5
# The first passes with few samples are ordinary ones, so that the end is MATLAB's
ORDINARY_PASSES = 60


def make_convex(newton: FloatArray, hessian: FloatArray) -> tuple[FloatArray, FloatArray | None]:
    """Return Newton's matrix (n, n) made positive definite, and a projection (n, n) or None.

    `hessian` (n, n): of an ordinary pass. The eigenvalues of `newton`, relative to it, become
    positive and not small. The projection is onto the directions in which they were negative.
    """
    scale = 1 / np.sqrt(np.maximum(np.diag(hessian), 1e-300))
    scaled = hessian * np.outer(scale, scale) + 1e-10 * np.eye(len(hessian))
    root = np.linalg.cholesky(scaled)
    inner = np.linalg.solve(root, np.linalg.solve(root, newton * np.outer(scale, scale)).T)
    values, vectors = np.linalg.eigh((inner + inner.T) / 2)
    both = root @ vectors / scale[:, None]
    convex = (both * np.clip(np.abs(values), SMALLEST_CURVATURE, 1)) @ both.T
    negative = values < 0
    if not negative.any():
        return convex, None
    return convex, np.linalg.solve(both.T, both.T * negative[:, None])


@dataclass(eq=False)
class RobustEnd:
    """The end of the passes: its `point`, and how far the passes settled.

    `outliers`: the share of samples with a weight below 1/2; `passes`: their number; `change`: of
    the fitted values in a next pass, as a share of their spread.
    """

    point: Point
    outliers: float
    passes: int
    change: float

    @property
    def converged(self) -> bool:
        """Whether the passes settled to `SETTLED`, beyond which few samples may cycle, too."""
        return self.change <= SETTLED


class RobustSearch:
    """The passes of a `RobustProblem`; `best`: the `RobustEnd` with the least change so far."""

    def __init__(self, problem: RobustProblem) -> None:
        self.problem = problem
        self.best: Any = None

    def search(
        self,
        u: FloatArray,
        weights: FloatArray,
        report: Progress,
        tolerance: float = SETTLED,
        ordinary_passes: int = ORDINARY_PASSES,
    ) -> RobustEnd:
        """Run passes from `u` and `weights`, and return the `RobustEnd`.

        They end if the next pass would change the fitted values by less than the `tolerance`, or
        after `PASSES`. The first `ordinary_passes` are ordinary ones. On Ctrl-C `Interrupted` is
        raised with the best end so far.
        """
        try:
            point = self.problem.make_point(u, weights)
            return self._run_passes(point, report, tolerance, ordinary_passes)
        except KeyboardInterrupt:
            if self.best is None:
                raise
            raise Interrupted(self.best) from None

    def _run_passes(
        self,
        point: Point,
        report: Progress,
        tolerance: float,
        ordinary_passes: int,
    ) -> RobustEnd:
        """Run the passes of `search` from a `Point`."""
        problem, near, solved = self.problem, NEAR_END, False
        for number in range(1, PASSES + 1):
            report(number, PASSES)
            scales = problem.estimate_scales(point)
            ratios = problem.divide_residuals(point, scales)
            factors = [problem.function(r) for r in ratios]
            # The step of an ordinary pass, and its change of the fitted values
            gradient, hessian = problem.expand_weighted(point, factors)
            ordinary = problem.find_best_step(hessian, gradient, point)
            change = np.sqrt(max(ordinary @ problem.metric @ ordinary, 0)) / problem.spread
            if solved and change > SLOW * self.best.change:
                problem.use_all_samples()
            astray = solved and change > self.best.change
            if self.best is None or change < self.best.change:
                outliers = float(np.mean([f < 0.5 for f in factors]))
                self.best = RobustEnd(point, outliers, number, change)
            if change <= tolerance:
                break
            solved = False
            if astray:
                # Go back, and reduce the merit until the end is nearer
                point, near = self.best.point, self.best.change / 3
            elif number <= ordinary_passes:
                point = self._reduce_merit(point, scales, (ordinary,))
            else:
                newton = problem.compute_newton_matrix(point, ratios)
                convex, concave = make_convex(newton, hessian)
                step = problem.find_best_step(convex, gradient, point)
                solved = change < near
                if solved:
                    step = self._step_to_fixed_point(point, ratios, scales, newton, gradient, step)
                    point = problem.take_step(point, step)
                else:
                    further = None if concave is None else concave @ step
                    point = self._reduce_merit(point, scales, (step, ordinary), further)
        self.best.passes = number
        return self.best

    def _reduce_merit(
        self,
        point: Point,
        scales: list[float],
        steps: Sequence[FloatArray],
        further: FloatArray | None = None,
    ) -> Point:
        """Return the point after the first of the `steps` that reduces the merit.

        Shorter steps are tried, too; the `scales` are constant. `further`: None, or the part of a
        step along which the merit is concave; it is added again, twice as long each time, while the
        merit falls.
        """
        before = self.problem.compute_merit(point, scales)
        for tried in (step / share for step in steps for share in (1, 2, 8)):
            moved = self.problem.take_step(point, tried)
            merit = self.problem.compute_merit(moved, scales)
            if merit <= before:
                break
        while further is not None and np.any(further):
            tried, further = tried + further, 2 * further
            longer = self.problem.take_step(point, tried)
            less = self.problem.compute_merit(longer, scales)
            if less >= merit:
                break
            moved, merit = longer, less
        return moved

    def _step_to_fixed_point(
        self,
        point: Point,
        ratios: list[FloatArray],
        scales: list[float],
        newton: FloatArray,
        gradient: FloatArray,
        step: FloatArray,
    ) -> FloatArray:
        """Return Newton's step v to the point where an ordinary pass changes nothing.

        It includes the change of the scales: g + H v + A (B v) = 0, with the columns ∂g/∂ln s of A
        and the rows ∂ln s/∂z of B. Parameters that `step` moves to a bound stay there.
        """
        A, B = self.problem.differentiate_scales(point, ratios, scales)
        z = point.to_vector() + step
        free = (z > self.problem.low) & (z < self.problem.high)
        matrix = newton[np.ix_(free, free)] + A[free] @ B[:, free]
        unit = 1 / np.sqrt(np.maximum(np.abs(np.diagonal(matrix)), 1e-300))
        whole_step = step.copy()
        solved = np.linalg.lstsq(matrix * np.outer(unit, unit), -gradient[free] * unit)
        whole_step[free] = solved[0] * unit
        return whole_step


def search_robust(
    problem: Problem,
    u: FloatArray,
    weights: FloatArray,
    name: str,
    rng: np.random.Generator,
    report: Progress,
) -> tuple[FloatArray, FloatArray, str, tuple[str, ...], tuple[list[FloatArray], list[FloatArray]]]:
    """Search a robust fit from the optimum where all samples count alike.

    Return (u, weights) at the end, a message, notes, and there the result of
    `RobustProblem.compute_weights_and_slopes`. `name`: a weight function of `WEIGHTS`. With many
    samples the search starts on a part of them, drawn by the generator `rng`. On Ctrl-C
    `Interrupted` is raised with the best `RobustEnd`.
    """
    samples = problem.samples
    if len(samples.wi) > MANY_SAMPLES:
        samples, rows = draw_subset(samples, np.ones(len(samples.wi)), MANY_SAMPLES // 2, rng)
        part = problem.with_samples(samples)
        first = RobustSearch(RobustProblem(part, u, weights, name))
        start = first.search(u, weights, report, LOOSE, ordinary_passes=0).point
        robust = RobustProblem(problem, u, weights, name, part, rows)
        end = RobustSearch(robust).search(start.u, start.weights, report, ordinary_passes=0)
    else:
        robust = RobustProblem(problem, u, weights, name)
        end = RobustSearch(robust).search(u, weights, report, EXACT)
    note = f"{name}: {end.outliers:.1%} of the samples count less than half; the loss is of all"
    message = f"settled in {end.passes} passes"
    if not end.converged:
        message = (
            f"did not settle in {end.passes} passes: the next would change the fitted values by "
            f"{end.change:.1g} of their spread"
        )
    u, weights = end.point.u, end.point.weights
    return u, weights, message, (note,), robust.compute_weights_and_slopes(u, weights)
