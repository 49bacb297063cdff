"""Searches for the solution of a robust fit, the fixed point of reweighting.

At the fixed point, the parameters are the best ones for weights of the samples that follow from the
residuals of these same parameters. A pass computes the weights from the residuals, then takes one
step towards the best parameters for these weights.

With few samples, the first passes are those of MATLAB's robustfit, which keeps the weights constant
during a step. Such "ordinary" passes become slow if much of a highlight is an outlier. Then Newton
steps replace them, which allow for the change of the weights during the step. Far from the fixed
point they reduce a merit function, in which the scales of the noise are constant. Near the fixed
point they solve for it directly, and allow for the change of the scales, too. A linear model takes
all its ordinary passes in `linear` before.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.interrupts import Interrupted
from brdfkit.core.progress_bar import Progress
from brdfkit.regression.problem.problem import Problem
from brdfkit.regression.problem.subset import Shares, draw_subset
from brdfkit.regression.robust.linear import reweight_linear_model
from brdfkit.regression.robust.problem import Point, RobustProblem

# Smallest curvature for a Newton step, as a share of the curvature for an ordinary step; it keeps
# Newton steps from becoming too long
SMALLEST_CURVATURE = 0.02
# Largest number of passes
PASSES = 150
# With more samples than this, the search starts on parts of these sizes, one after the other
MANY_SAMPLES = 80_000
PARTS = 8_000, 40_000
# The passes on fewer samples than this for each lobe might go in cycles, and are left out
SAMPLES_PER_LOBE = 400
# Passes have converged if the next would change the fitted values by less than this share of their
# standard deviation
SETTLED = 3e-7
# Passes on few samples go on until the next would change the fitted values by less than this share
EXACT = 1e-11
# Passes on a part of the samples, which only give a start, end at this share already
LOOSE = 1e-5
# Newton steps solve for the fixed point once an ordinary pass would change the fitted values by
# less than this share of their standard deviation
NEAR_END = 1e-3
# If a Newton step to the fixed point leaves more than this share of the way, later Hessians are
# computed from all samples
SLOW = 0.5
# Number of first passes on few samples that are ordinary ones, so that the solution is MATLAB's
ORDINARY_PASSES = 60


def make_newton_matrix_convex(
    newton: FloatArray, hessian: FloatArray
) -> tuple[FloatArray, FloatArray | None]:
    """Return Newton's matrix (n, n) made positive definite, so that its step reduces the merit.

    Return also the projection (n, n) onto the directions of negative curvature, or None.
    `newton` (n, n): the matrix; `hessian` (n, n): the positive definite Hessian of an ordinary
    pass, relative to which eigenvalues of `newton` become positive and not small.
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
    """The solution of a robust fit, and how well its passes converged.

    `point`: the solution; `outliers`: share of the samples with a weight below 1/2; `passes`:
    number of passes; `change`: root mean square by which another pass would change the fitted
    values, as a share of their standard deviation.
    """

    point: Point
    outliers: float
    passes: int
    change: float

    @property
    def converged(self) -> bool:
        """Whether another pass would change the fitted values by at most the share `SETTLED`.

        Passes on few samples may go in cycles that change the values by less.
        """
        return self.change <= SETTLED


class RobustSearch:
    """A search for the solution of a robust fit by passes, each a step with updated weights.

    `problem`: the `RobustProblem`; `best`: the `RobustEnd` with the least change so far, or None.
    """

    def __init__(self, problem: RobustProblem) -> None:
        self.problem = problem
        self.best: Any = None

    def run_search(
        self,
        u: FloatArray,
        weights: FloatArray,
        report: Progress,
        tolerance: float = SETTLED,
        ordinary_passes: int = ORDINARY_PASSES,
    ) -> RobustEnd:
        """Run passes from the parameters `u` and `weights`, and return the `RobustEnd`.

        The passes end if the next one would change the fitted values by less than the `tolerance`,
        or after `PASSES`. The first `ordinary_passes` keep the samples' weights constant during a
        step. On Ctrl-C `Interrupted` is raised with the best end so far.
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
        """Run the passes of `run_search` from a start `point`, with the same other arguments."""
        problem, near, solved = self.problem, NEAR_END, False
        for number in range(1, PASSES + 1):
            report(number, PASSES)
            scales = problem.estimate_scales(point)
            ratios = problem.scale_residuals(point, scales)
            factors = [problem.function(r) for r in ratios]
            # How much would the step of an ordinary pass change the fitted values?
            gradient, hessian = problem.expand_weighted_loss(point, factors)
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
                # The last step led away: return to the best point, and reduce the merit for a while
                point, near = self.best.point, self.best.change / 3
            elif number <= ordinary_passes:
                point = self._reduce_merit(point, scales, (ordinary,))
            else:
                newton = problem.compute_newton_matrix(point, ratios)
                convex, concave = make_newton_matrix_convex(newton, hessian)
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
        """Return the point after the first of the `steps` that does not increase the merit.

        Shorter steps in the same directions are tried, too. `scales`: constant scales of the noise;
        `further`: None, or the part of a step along which the merit is concave; it is added again,
        twice as long each time, while the merit falls.
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
        """Return Newton's step v to the point where an ordinary pass would change nothing.

        The step solves g + H v + A (B v) = 0 with the gradient g and Newton's matrix H. A (B v)
        is the effect of the change of the noise's scales s: B is ∂ln s/∂z, with the parameters z of
        the point, and A is ∂g/∂ln s. Parameters that `step` moves to a bound stay there. `ratios`:
        scaled residuals by channel.
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


def search_robust_solution(
    problem: Problem,
    u: FloatArray,
    weights: FloatArray,
    name: str,
    rng: np.random.Generator,
    report: Progress,
) -> tuple[FloatArray, FloatArray, str, tuple[str, ...], tuple[list[FloatArray], list[FloatArray]]]:
    """Search for the solution of a robust fit, from the optimum `u`, `weights` with equal weights.

    Return (u, weights, message, notes) of the solution and the weights and slopes of the samples
    there, as `RobustProblem.compute_weights_and_slopes` returns them. `name`: a weight function of
    `WEIGHTS`; `rng`: a generator; of many samples it draws a part, on which the search starts. On
    Ctrl-C `Interrupted` is raised with the best `RobustEnd`.
    """
    samples = problem.samples
    if len(samples.wi) > MANY_SAMPLES:
        start, even = (u, weights), Shares.from_influence(samples, np.ones(len(samples.wi)))
        for size in PARTS:  # each search starts at the end of the search on fewer samples
            if size < SAMPLES_PER_LOBE * weights.shape[2]:
                continue
            chosen, rows = draw_subset(samples, even, size, rng)
            part = problem.with_samples(chosen)
            first = RobustSearch(RobustProblem(part, u, weights, name))
            end = first.run_search(*start, report, LOOSE, ordinary_passes=0)
            if end.change <= LOOSE or size == PARTS[-1]:
                start = end.point.u, end.point.weights
        robust = RobustProblem(problem, u, weights, name, part, rows)
        end = RobustSearch(robust).run_search(*start, report, ordinary_passes=0)
    else:
        robust, passes = RobustProblem(problem, u, weights, name), 0
        if robust.is_linear:  # mostly the search then finds that it starts at the solution
            weights, passes = reweight_linear_model(robust, weights, EXACT, PASSES)
        ordinary_passes = 0 if passes else ORDINARY_PASSES
        end = RobustSearch(robust).run_search(u, weights, report, 10 * EXACT, ordinary_passes)
        end.passes += passes
    note = f"{name}: {end.outliers:.1%} of the samples count less than half; the loss is of all"
    message = f"settled in {end.passes} passes"
    if not end.converged:
        message = (
            f"did not settle in {end.passes} passes: the next would change the fitted values by "
            f"{end.change:.1g} of their spread"
        )
    u, weights = end.point.u, end.point.weights
    return u, weights, message, (note,), robust.compute_weights_and_slopes(u, weights)
