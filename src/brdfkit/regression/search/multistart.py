"""Searches from many starts at once, on ever larger parts of the samples."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import lru_cache

import numpy as np

from brdfkit.core.array_types import BoolArray, FloatArray
from brdfkit.core.progress_bar import Progress
from brdfkit.regression.problem.expansion import Expansion
from brdfkit.regression.problem.problem import Problem
from brdfkit.regression.problem.subset import draw_subset
from brdfkit.regression.search.levenberg_marquardt import Search, levenberg_marquardt
from brdfkit.regression.search.zero_weights import revive_zero_weights

# Sizes of parts of many samples. All starts are searched on the smallest part, those with the best
# ends on the next one, and the best on all samples; a part is at most half of the next
PARTS = 40_000, 3_000
# (number of starts that continue, after this number of steps). The second rule applies to more
# shape parameters than FEW_SHAPES, as sums of models have: few starts lead to their best end
FEW_SHAPES_ROUNDS, MANY_SHAPES_ROUNDS = ((24, 4), (8, 6)), ((32, 20), (8, 30))
FEW_SHAPES = 3
# From a part, ends within this share of the least E² are followed to all samples, at most so many
CLOSE, FINALISTS = 0.02, 3
LARGEST_STEPS, FEW_STEPS = 200, 10
# A search converges if the next step would lower E² by less than this share of it: the first on few
# samples, times the second on many, and the third on a part of them
EXACT, MANY_SAMPLES_FACTOR, LOOSE = 1e-11, 100, 1e-6


def default_start_count(shapes: int) -> int:
    """Return the default number of start points for this number of shape parameters."""
    return max(1, min(16 * shapes, 96))


def make_start_points(default: FloatArray, count: int, seed: int) -> FloatArray:
    """Return start points (count, shapes) as coordinates: `default`, then points over the bounds.

    Halton's sequence spreads these points. Without shape parameters there is one start point.
    """
    count = count if len(default) else 1
    return np.vstack([default, *_spread_points(len(default), count - 1, seed)])


@lru_cache
def _spread_points(dimensions: int, count: int, seed: int) -> FloatArray | tuple[()]:
    """Return points (count, dimensions) of Halton's sequence, scrambled by `seed`."""
    from scipy.stats import qmc

    return qmc.Halton(dimensions, rng=seed).random(count) if count and dimensions else ()


def make_part_problems(whole: Problem, rng: np.random.Generator) -> list[Problem]:
    """Return the problems of a search: parts of many samples, the smallest first, then `whole`."""
    problems = [whole]
    # A clamped model has many ends, and a small part has other ends than the whole
    for size in PARTS[:1] if whole.clamped else PARTS:
        samples = problems[0].samples
        if 2 * size < len(samples.wi):
            part, _ = draw_subset(samples, problems[0].black_squares, size, rng)
            problems.insert(0, whole.with_samples(part))
    return problems


def search_from_starts(
    problems: Sequence[Problem],
    u: FloatArray,
    report: Progress,
    iterations: int = LARGEST_STEPS,
    tolerance: float = EXACT,
) -> tuple[Expansion, BoolArray, int]:
    """Search `problems`, on ever larger parts of the samples, from `u` (starts, shapes).

    Return the `Expansion` about the ends, the best first, which of them converged, and the number
    of evaluations. `iterations`, `tolerance`: see `levenberg_marquardt`.
    """
    first, last, starts = problems[0], problems[-1], u
    weights, evaluations = first.estimate_weights(u), 0
    if first.clamped:
        u, weights = _add_unclamped_starts(first, u, weights)
    # A few steps from all starts, a few more from the best of these, and so on
    for count, steps in MANY_SHAPES_ROUNDS if u.shape[1] > FEW_SHAPES else FEW_SHAPES_ROUNDS:
        search = levenberg_marquardt(first.expand, u, weights, first.least, steps)
        evaluations += search.evaluations
        ends = search.ends.select(search.find_best(count))
        u, weights = ends.u, ends.weights
    revived = revive_zero_weights(first, ends.select([0]), starts)
    u, weights = (np.concatenate(parts) for parts in zip((u, weights), revived, strict=True))
    for number, problem in enumerate(problems):
        report(number, len(problems))
        if number:
            rows = search.find_best(FINALISTS)
            error = search.ends.error
            ends = search.ends.select(rows[error[rows] <= (1 + CLOSE) * error[rows[0]]])
            u, weights = ends.u, ends.weights
        # A clamped model moves slowly from kink to kink, which is cheaper on a part
        tight = MANY_SAMPLES_FACTOR * tolerance
        loose = tight if problem.clamped else max(LOOSE, tight)
        limit = loose if problem is not last else tight if number else tolerance
        part = problems[number - 1] if number else None
        search, count = _search_problem(problem, part, u, weights, iterations, limit)
        evaluations += count
    report(len(problems), len(problems))
    best = search.find_best(FINALISTS)
    return search.ends.select(best), search.converged[best], evaluations


def _add_unclamped_starts(problem: Problem, u: FloatArray, weights: FloatArray) -> list[FloatArray]:
    """Return more starts (u, weights), by which more or less of the model is clamped at 0.

    A search may stall where much of the model is clamped.
    """
    extended = Problem(problem.model, problem.samples, problem.loss, problem.space, extended=True)
    ends = levenberg_marquardt(extended.expand, u, weights, problem.least, LARGEST_STEPS).ends
    evenly = problem.estimate_weights(u, evenly=True)
    starts = [(u, weights), (ends.u, ends.weights), (u, evenly), (u, (evenly + weights) / 2)]
    starts.append(((u + ends.u) / 2, (weights + ends.weights) / 2))
    return [np.concatenate(parts) for parts in zip(*starts, strict=True)]


def _search_problem(
    problem: Problem,
    part: Problem | None,
    u: FloatArray,
    weights: FloatArray,
    iterations: int,
    tolerance: float,
) -> tuple[Search, int]:
    """Search a problem from `u` and `weights`; return the `Search` and the number of evaluations.

    `part`: None, or a problem on a part of the samples, whose ends are the starts.
    """
    evaluations, damping = 0, 1e-4
    if part is not None:
        # All samples have nearly the Hessian of a part, if the part represents them
        expand, damping = _borrow_curvature(problem, part), 1e-7
        search = levenberg_marquardt(
            expand, u, weights, problem.least, FEW_STEPS, tolerance, damping
        )
        if search.converged.all():
            return search, search.evaluations
        u, weights, evaluations = search.ends.u, search.ends.weights, search.evaluations
    search = levenberg_marquardt(
        problem.expand, u, weights, problem.least, iterations, tolerance, damping
    )
    return search, evaluations + search.evaluations


def _borrow_curvature(
    whole: Problem, part: Problem
) -> Callable[[FloatArray, FloatArray], Expansion]:
    """Return the function `whole.expand` with the Hessian of `part`, a part of its samples."""

    def expand(u: FloatArray, weights: FloatArray) -> Expansion:
        expansion = whole.expand(u, weights, curvature=False)
        near = part.expand_at_weights(u, weights)
        return replace(expansion, hessian=near.hessian, gram=near.gram)

    return expand
