"""A robust fit: weights of the samples and parameters of the model that give each other back.

A pass weighs the samples by their residuals, then takes one step towards the best parameters for
these weights. Of few samples the first passes are those of MATLAB's robustfit, which solves for the
parameters with the weights held. They creep where much of a highlight is an outlier, and are
replaced by Newton's steps, which know how the weights change with the parameters: far from the end
such as make a merit smaller, at held scales; near it such as lead to where an ordinary pass would
change nothing, with the scales. The end is the same: there, recomputed weights give the solution
back.
"""

from dataclasses import dataclass

import numpy as np

from brdfkit.core.interrupts import Interrupted
from brdfkit.regression.problem.subset import draw_part
from brdfkit.regression.robust.problem import Point, RobustProblem

# Newton's steps are at most 1 / this times longer than ordinary ones, in each direction
LEAST_CURVATURE = 0.02


def make_convex(newton, hessian):
    """Newton's matrix (n, n) with eigenvalues, beside those of `hessian`, an ordinary pass's, that
    are positive and not small, and the projection (n, n) onto the directions where they were
    negative, or None."""
    scale = 1 / np.sqrt(np.maximum(np.diag(hessian), 1e-300))
    scaled = hessian * np.outer(scale, scale) + 1e-10 * np.eye(len(hessian))
    root = np.linalg.cholesky(scaled)
    inner = np.linalg.solve(root, np.linalg.solve(root, newton * np.outer(scale, scale)).T)
    values, vectors = np.linalg.eigh((inner + inner.T) / 2)
    both = root @ vectors / scale[:, None]
    convex = (both * np.clip(np.abs(values), LEAST_CURVATURE, 1)) @ both.T
    negative = values < 0
    if not negative.any():
        return convex, None
    return convex, np.linalg.solve(both.T, both.T * negative[:, None])


PASSES = 150
# So many samples settle on half as many first
MANY = 80_000
# Settled: the next pass would change the fitted values by this share of their spread (rms)
SETTLED = 3e-7
# Few samples settle to this share
EXACTLY = 1e-11
# The same for a part, whose end is only a start
LOOSE = 1e-5
# Where a pass changes them by less than this share, the end is near
NEAR = 1e-3
# Where a step to the end leaves more of the change than this, a part's Hessian is too rough
SLOW = 0.5
# So many passes of few samples are ordinary ones first, that the end is MATLAB's
ORDINARY = 60


@dataclass(eq=False)
class Settled:
    """Where the passes ended: the `point`, the share of samples that are `light`, the number of
    `passes`, and the change that the next would bring, as a share of the spread."""

    point: Point
    light: float
    passes: int
    change: float

    @property
    def converged(self):
        return self.change <= SETTLED  # of few samples, too: some go round in small circles


class Passes:
    """The passes of a `RobustProblem`; `best`: the `Settled` that changes least so far."""

    def __init__(self, problem):
        self.problem, self.best = problem, None

    def settle(self, u, weights, report, tolerance=SETTLED, patience=ORDINARY):
        """The `Settled` end of the passes from `u` and `weights`: the next would change the fitted
        values by less than the `tolerance`, or there were too many. The first `patience` passes are
        ordinary ones. On Ctrl-C `Interrupted` has the best end so far."""
        try:
            return self._settle(self.problem.at(u, weights), report, tolerance, patience)
        except KeyboardInterrupt:
            if self.best is None:
                raise
            raise Interrupted(self.best) from None

    def _settle(self, point, report, tolerance, patience):
        problem, near, solved = self.problem, NEAR, False
        for number in range(1, PASSES + 1):
            report(number, PASSES)
            scales = problem.scales(point)
            ratios = problem.ratios(point, scales)
            factors = [problem.function(r) for r in ratios]
            # The step of an ordinary pass, and the change of fitted values that it brings
            gradient, hessian = problem.weigh(point, factors)
            ordinary = problem.best_step(hessian, gradient, point)
            change = np.sqrt(max(ordinary @ problem.metric @ ordinary, 0)) / problem.spread
            if solved and change > SLOW * self.best.change:
                problem.forget_part()
            astray = solved and change > self.best.change
            if self.best is None or change < self.best.change:
                light = float(np.mean([f < 0.5 for f in factors]))
                self.best = Settled(point, light, number, change)
            if change <= tolerance:
                break
            solved = False
            if astray:
                # Back, and nearer to the end by merits first
                point, near = self.best.point, self.best.change / 3
            elif number <= patience:
                point = self._descend(point, scales, (ordinary,))
            else:
                newton = problem.newton(point, ratios)
                convex, concave = make_convex(newton, hessian)
                step = problem.best_step(convex, gradient, point)
                solved = change < near
                if solved:
                    found = self._solve(point, ratios, scales, newton, gradient, step)
                    point = problem.move(point, found)
                else:
                    further = None if concave is None else concave @ step
                    point = self._descend(point, scales, (step, ordinary), further)
        self.best.passes = number
        return self.best

    def _descend(self, point, scales, steps, further=None):
        """The point after the first of the `steps`, or shorter ones, by which the merit at held
        `scales` is smaller; `further`: the part of a step, or None, along which the merit bends
        down: it is repeated, and doubled, while the merit falls."""
        before = self.problem.merit(point, scales)
        for tried in (step / share for step in steps for share in (1, 2, 8)):
            found = self.problem.move(point, tried)
            merit = self.problem.merit(found, scales)
            if merit <= before:
                break
        while further is not None and np.any(further):
            tried, further = tried + further, 2 * further
            longer = self.problem.move(point, tried)
            less = self.problem.merit(longer, scales)
            if less >= merit:
                break
            found, merit = longer, less
        return found

    def _solve(self, point, ratios, scales, newton, gradient, step):
        """Newton's step v to where an ordinary pass changes nothing, with the change of the scales;
        what a `step` brings to a bound stays there.

        g + H v + A (B v) = 0, with the columns ∂g/∂ln s of A and the rows ∂ln s/∂z of B.
        """
        A, B = self.problem.by_scales(point, ratios, scales)
        z = point.join() + step
        free = (z > self.problem.low) & (z < self.problem.high)
        matrix = newton[np.ix_(free, free)] + A[free] @ B[:, free]
        unit = 1 / np.sqrt(np.maximum(np.abs(np.diagonal(matrix)), 1e-300))
        found = step.copy()
        solved = np.linalg.lstsq(matrix * np.outer(unit, unit), -gradient[free] * unit)
        found[free] = solved[0] * unit
        return found


def settle(problem, u, weights, name, rng, report):
    """The end (u, weights) of a robust fit from the optimum where all samples count alike, a
    message, notes, and what each sample has to say, as `RobustProblem.say`.

    Many samples settle on a part of them first, drawn by the generator `rng`. On Ctrl-C
    `Interrupted` has the best `Settled` so far.
    """
    samples = problem.samples
    many = len(samples.wi) > MANY
    if many:
        samples, rows = draw_part(samples, np.ones(len(samples.wi)), MANY // 2, rng)
        part = problem.on(samples)
        first = Passes(RobustProblem(part, u, weights, name))
        start = first.settle(u, weights, report, LOOSE, patience=0).point
        robust = RobustProblem(problem, u, weights, name, part, rows)
        found = Passes(robust).settle(start.u, start.weights, report, patience=0)
    else:
        robust = RobustProblem(problem, u, weights, name)
        found = Passes(robust).settle(u, weights, report, EXACTLY)
    note = f"{name}: {found.light:.1%} of the samples count less than half; the loss is of all"
    message = f"settled in {found.passes} passes"
    if not found.converged:
        message = (
            f"did not settle in {found.passes} passes: the next would change the fitted values by "
            f"{found.change:.1g} of their spread"
        )
    u, weights = found.point.u, found.point.weights
    return u, weights, message, (note,), robust.say(u, weights)
