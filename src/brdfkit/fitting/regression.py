"""Regresses a model on samples: compares starts, searches from the best, weighs down outliers."""

import math
from dataclasses import dataclass, replace

import numpy as np

from brdfkit.fitting.folding import fold
from brdfkit.fitting.levenberg_marquardt import levenberg_marquardt
from brdfkit.fitting.parameter_space import Space
from brdfkit.fitting.part import draw_part
from brdfkit.fitting.problem import Problem
from brdfkit.fitting.robust_search import settle
from brdfkit.fitting.starting_points import start_points, usual_starts
from brdfkit.jit.threads import in_turn

# Many samples are searched by parts: all starts on the smallest, those that end best on the next,
# and the best on all; no part is more than half of what it is drawn from
PARTS = 40_000, 3_000
# How many starts go on after so many steps
EXPLORING = (24, 4), (8, 6)
# Ends on a part within this share of the least E² are followed to all samples, up to so many
CLOSE, FINALISTS = 0.02, 3
MOST_STEPS, FEW_STEPS = 200, 10
# A search ends where the next step would lower E² by less than this share of it: of few samples, of
# many, and of a part of them
EXACT, TIGHT, LOOSE = 1e-11, 1e-9, 1e-6


@dataclass(frozen=True, eq=False)
class Solution:
    """Where a regression ended.

    `shapes`: the shape parameters by name; `weights`: (channels, lobes); `loss`: E; `evaluations`:
    how often E was computed; `message`: why the search stopped; `at_bounds`: parameters that ended
    on a bound; `notes`: what else one should know.
    """

    shapes: dict[str, float]
    weights: np.ndarray
    loss: float
    evaluations: int
    message: str
    at_bounds: tuple[str, ...]
    notes: tuple[str, ...]


@in_turn
def regress(
    model,
    samples,
    loss,
    *,
    robust=None,
    starts=None,
    bounds=None,
    fixed=None,
    anisotropic=False,
    seed=0,
    report=None,
):
    """The `Solution` of a model class on valid `Samples` under a `Loss`.

    `robust`: a name in `fitting.robust.WEIGHTS`; `starts`: how many points the search begins at,
    the model's defaults and points spread over the bounds, by default `usual_starts`; `bounds`:
    (low, high), and `fixed`: a value, by shape parameter; `anisotropic`: search the second
    parameter of an anisotropic model, such as ``alpha_v``, too; `seed`: for the start points, and
    for the parts of many samples by which they are compared; `report`: called with (done, total).
    """
    bounds, report = bounds or {}, report or (lambda done, total: None)
    # What is searched: neither fixed nor determined by the measured directions
    given = {n: v for n, v in model.determined(samples).items() if n not in bounds} | (fixed or {})
    space = Space.of(model, bounds, given, anisotropic)
    whole = Problem(model, samples, loss, space)
    rng = np.random.default_rng(seed)
    folded = fold(whole)
    problems = [folded] if folded else with_parts(whole, rng)
    default = space.coordinates(model().values)
    points = start_points(space, default, starts or usual_starts(len(space.names)), seed)
    end, converged, evaluations = search(problems, points, report)
    message = "converged" if converged else f"stopped after {MOST_STEPS} steps"
    error, u, weights, notes = end.error[0], end.u, end.weights, ()
    # Weigh down outliers, from the optimum where all samples count alike
    if robust:
        u, weights, message, notes = settle(whole, u, weights, robust, rng, report)
        error = whole.sums(u, weights, curvature=False).error[0]
    return Solution(
        space.values(u[0]),
        weights[0],
        math.sqrt(error),
        evaluations,
        message,
        _find_at_bounds(space, u[0], model, weights[0]),
        notes,
    )


def with_parts(whole, rng):
    """The problems of a search: `whole`, and before it those on ever smaller parts of its samples,
    where these are many."""
    problems = [whole]
    for size in PARTS:
        samples = problems[0].samples
        if 2 * size < len(samples.wi):
            part, _ = draw_part(samples, problems[0].black(), size, rng)
            problems.insert(0, whole.on(part))
    return problems


def search(problems, u, report):
    """The `Expansion` about the one point where the search of `problems`, on ever more of the
    samples, ends, whether it converged, and the number of evaluations; `u` (starts, shapes): where
    it begins."""
    first, last = problems[0], problems[-1]
    weights, evaluations = first.start(u), 0
    if first.clamped:
        u, weights = _avoid_clamping(first, u, weights)
    # A few steps from all starts, a few more from the best of these, and so on
    for count, steps in EXPLORING:
        found = levenberg_marquardt(first.expand, u, weights, first.least, steps)
        evaluations += found.evaluations
        ends = found.ends.at(found.best(count))
        u, weights = ends.u, ends.weights
    for number, problem in enumerate(problems):
        report(number, len(problems))
        if number:
            rows = found.best(FINALISTS)
            error = found.ends.error
            ends = found.ends.at(rows[error[rows] <= (1 + CLOSE) * error[rows[0]]])
        tolerance = LOOSE if problem is not last else TIGHT if number else EXACT
        part = problems[number - 1] if number else None
        found, count = _descend(problem, part, ends, tolerance)
        evaluations += count
    report(len(problems), len(problems))
    (best,) = found.best(1)
    return found.ends.at([best]), bool(found.converged[best]), evaluations


def _avoid_clamping(problem, u, weights):
    """More starts, with weights by which more or less of the model is clamped at 0: where much is,
    a search may rest."""
    extended = Problem(problem.model, problem.samples, problem.loss, problem.space, extended=True)
    ends = levenberg_marquardt(extended.expand, u, weights, problem.least, MOST_STEPS).ends
    evenly = problem.start(u, evenly=True)
    starts = [(u, weights), (ends.u, ends.weights), (u, evenly), (u, (evenly + weights) / 2)]
    return [np.concatenate(parts) for parts in zip(*starts, strict=True)]


def _descend(problem, part, ends, tolerance):
    """The `Search` of a problem from the points of an `Expansion`, and the number of evaluations;
    `part`: a problem on some of its samples, at whose ends it begins, or None."""
    evaluations, damping = 0, 1e-4
    if part is not None:
        # The Hessian of all samples is nearly that of a part, if the part is like them
        expand, damping = _borrow_curvature(problem, part), 1e-7
        found = levenberg_marquardt(
            expand, ends.u, ends.weights, problem.least, FEW_STEPS, tolerance, damping
        )
        if found.converged.all():
            return found, found.evaluations
        ends, evaluations = found.ends, found.evaluations
    found = levenberg_marquardt(
        problem.expand, ends.u, ends.weights, problem.least, MOST_STEPS, tolerance, damping
    )
    return found, evaluations + found.evaluations


def _borrow_curvature(whole, part):
    """The function `whole.expand` with the Hessian of `part`, a problem on some of its samples."""

    def expand(u, weights):
        expansion = whole.expand(u, weights, curvature=False)
        near = part.expand_here(u, weights)
        return replace(expansion, hessian=near.hessian, gram=near.gram)

    return expand


def _find_at_bounds(space, u, model, weights):
    """The parameters that ended on a bound: weights of 0 in all channels, then shape parameters."""
    shapes = [n for n, v in zip(space.names, u, strict=True) if min(v, 1 - v) < 1e-6]
    black = [n for n, w in zip(model.weights(), weights.T, strict=True) if (w == 0).all()]
    return (*(n for n in black if model.parameters[n].bounds[0] == 0), *shapes)
