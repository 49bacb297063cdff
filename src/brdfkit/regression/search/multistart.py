"""The search for the end of a fit: all starts at once, on ever more of the samples."""

from dataclasses import replace

import numpy as np

from brdfkit.regression.problem.problem import Problem
from brdfkit.regression.problem.subset import draw_part
from brdfkit.regression.search.levenberg_marquardt import levenberg_marquardt
from brdfkit.regression.search.zero_weights import light_up

# Many samples are searched by parts: all starts on the smallest, those that end best on the next,
# and the best on all; no part is more than half of what it is drawn from
PARTS = 40_000, 3_000
# How many starts go on after so many steps; and where more shape parameters are searched than FEW,
# those of a sum, whose best end few starts lead to
EXPLORING, LONGER = ((24, 4), (8, 6)), ((32, 20), (8, 30))
FEW = 3
# Ends on a part within this share of the least E² are followed to all samples, up to so many
CLOSE, FINALISTS = 0.02, 3
MOST_STEPS, FEW_STEPS = 200, 10
# A search ends where the next step would lower E² by less than this share of it: of few samples, so
# many times as much of many, and of a part of them
EXACT, MANY, LOOSE = 1e-11, 100, 1e-6


def with_parts(whole, rng):
    """The problems of a search: `whole`, and before it those on ever smaller parts of its samples,
    where these are many."""
    problems = [whole]
    # A clamped model has so many ends that a small part has others than the whole
    for size in PARTS[:1] if whole.clamped else PARTS:
        samples = problems[0].samples
        if 2 * size < len(samples.wi):
            part, _ = draw_part(samples, problems[0].black, size, rng)
            problems.insert(0, whole.on(part))
    return problems


def search(problems, u, report, iterations=MOST_STEPS, tolerance=EXACT):
    """The `Expansion` about the points, the best first, where the search of `problems`, on ever
    more of the samples, ends, which of them converged, and the number of evaluations; `u`
    (starts, shapes): where it begins; `iterations`, `tolerance`: see `levenberg_marquardt`."""
    first, last, starts = problems[0], problems[-1], u
    weights, evaluations = first.start(u), 0
    if first.clamped:
        u, weights = _avoid_clamping(first, u, weights)
    # A few steps from all starts, a few more from the best of these, and so on
    for count, steps in LONGER if u.shape[1] > FEW else EXPLORING:
        found = levenberg_marquardt(first.expand, u, weights, first.least, steps)
        evaluations += found.evaluations
        ends = found.ends.at(found.best(count))
        u, weights = ends.u, ends.weights
    lit = light_up(first, ends.at([0]), starts)
    u, weights = (np.concatenate(parts) for parts in zip((u, weights), lit, strict=True))
    for number, problem in enumerate(problems):
        report(number, len(problems))
        if number:
            rows = found.best(FINALISTS)
            error = found.ends.error
            ends = found.ends.at(rows[error[rows] <= (1 + CLOSE) * error[rows[0]]])
            u, weights = ends.u, ends.weights
        # A clamped model creeps from kink to kink: let it do so on a part
        tight = MANY * tolerance
        loose = tight if problem.clamped else max(LOOSE, tight)
        limit = loose if problem is not last else tight if number else tolerance
        part = problems[number - 1] if number else None
        found, count = _descend(problem, part, u, weights, iterations, limit)
        evaluations += count
    report(len(problems), len(problems))
    best = found.best(FINALISTS)
    return found.ends.at(best), found.converged[best], evaluations


def _avoid_clamping(problem, u, weights):
    """More starts, with weights by which more or less of the model is clamped at 0: where much is,
    a search may rest."""
    extended = Problem(problem.model, problem.samples, problem.loss, problem.space, extended=True)
    ends = levenberg_marquardt(extended.expand, u, weights, problem.least, MOST_STEPS).ends
    evenly = problem.start(u, evenly=True)
    starts = [(u, weights), (ends.u, ends.weights), (u, evenly), (u, (evenly + weights) / 2)]
    starts.append(((u + ends.u) / 2, (weights + ends.weights) / 2))
    return [np.concatenate(parts) for parts in zip(*starts, strict=True)]


def _descend(problem, part, u, weights, iterations, tolerance):
    """The `Search` of a problem from the points `u` and `weights`, and the number of evaluations;
    `part`: a problem on some of its samples, at whose ends it begins, or None."""
    evaluations, damping = 0, 1e-4
    if part is not None:
        # The Hessian of all samples is nearly that of a part, if the part is like them
        expand, damping = _borrow_curvature(problem, part), 1e-7
        found = levenberg_marquardt(
            expand, u, weights, problem.least, FEW_STEPS, tolerance, damping
        )
        if found.converged.all():
            return found, found.evaluations
        u, weights, evaluations = found.ends.u, found.ends.weights, found.evaluations
    found = levenberg_marquardt(
        problem.expand, u, weights, problem.least, iterations, tolerance, damping
    )
    return found, evaluations + found.evaluations


def _borrow_curvature(whole, part):
    """The function `whole.expand` with the Hessian of `part`, a problem on some of its samples."""

    def expand(u, weights):
        expansion = whole.expand(u, weights, curvature=False)
        near = part.expand_here(u, weights)
        return replace(expansion, hessian=near.hessian, gram=near.gram)

    return expand
