"""Searches for the least squared loss E² from many start points, on growing parts of the samples.

All starts are searched on a small part of the samples, which is fast. Only the best ends go on to
larger parts, and at last to all samples.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import lru_cache

import numpy as np

from brdfkit.core.array_types import BoolArray, FloatArray
from brdfkit.core.progress_bar import Progress
from brdfkit.core.quasi_random import draw_halton_points
from brdfkit.regression.problem.expansion import Expansion
from brdfkit.regression.problem.problem import Problem
from brdfkit.regression.problem.subset import draw_subset
from brdfkit.regression.search.levenberg_marquardt import Search, levenberg_marquardt
from brdfkit.regression.search.zero_weights import revive_zero_weights

# Numbers of samples in the parts on which a search starts, the largest first. A part is used if it
# is less than half of the next larger one
PARTS = 40_000, 3_000
# Models with more shape parameters, such as sums of models, need more steps from more starts
FEW_SHAPES = 3
# Rounds of a search, each a pair: number of starts that continue, and number of steps before
# they are chosen
FEW_SHAPES_ROUNDS: tuple[tuple[int, int], ...] = ((24, 4), (8, 6))
MANY_SHAPES_ROUNDS: tuple[tuple[int, int], ...] = ((32, 20), (8, 30))
# Ends on a part go on to more samples if their squared loss is within this share of the least one
CLOSE = 0.02
# Largest number of ends that go on to more samples
FINALISTS = 3
# Largest number of steps of a search, first with the Hessian of its samples, then with a part's
LARGEST_STEPS, FEW_STEPS = 200, 10
# A search converges if the next step would lower the squared loss by less than this share
EXACT = 1e-11
# Factor of this share, `EXACT`, in a search on many samples
MANY_SAMPLES_FACTOR = 100
# The share in a search on a part of the samples, whose end is only a start for all of them
LOOSE = 1e-6


def choose_start_count(shapes: int) -> int:
    """Return the default number of start points for a model with this many shape parameters."""
    return max(1, min(16 * shapes, 96))


def make_start_points(default: FloatArray, count: int, seed: int) -> FloatArray:
    """Return start points of a search, as coordinates (count, shapes) between the bounds.

    The first one is `default` (shapes,); a Halton sequence with a `seed` spreads the others over
    the bounds. A model without shape parameters has one start point.
    """
    count = count if len(default) else 1
    return np.vstack([default, *_spread_points(len(default), count - 1, seed)])


@lru_cache
def _spread_points(dimensions: int, count: int, seed: int) -> FloatArray | tuple[()]:
    """Return points (count, dimensions) in the unit cube, by a Halton sequence with a `seed`."""
    return draw_halton_points(count, dimensions, seed) if count and dimensions else ()


def make_part_problems(whole: Problem, rng: np.random.Generator) -> list[Problem]:
    """Return problems on parts of many samples, the smallest part first, and last the `whole`.

    With few samples there is only the whole problem. `rng`: a generator that draws the parts.
    """
    problems = [whole]
    # A model clamped at 0 has many local minima, and a small part of the samples has different ones
    for size in PARTS[:1] if whole.clamped else PARTS:
        samples = problems[0].samples
        if 2 * size < len(samples.wi):
            part, _ = draw_subset(samples, problems[0].shares, size, rng)
            problems.insert(0, whole.with_samples(part))
    return problems


def search_from_starts(
    problems: Sequence[Problem],
    u: FloatArray,
    report: Progress,
    iterations: int = LARGEST_STEPS,
    tolerance: float = EXACT,
) -> tuple[Expansion, BoolArray, int]:
    """Search for the least squared loss E² from many starts, on each of the problems in turn.

    Return the expansion of E² about the ends on the last problem, the best first, whether each of
    them converged, and the number of evaluations. `problems`: problems on growing parts of the
    samples; `u` (starts, shapes): coordinates of the starts; `report`: a function that is called
    with the rounds and problems done and their number; `iterations`, `tolerance`: see
    `levenberg_marquardt`.
    """
    first, last, starts = problems[0], problems[-1], u
    weights, evaluations = first.estimate_weights(u), 0
    if first.clamped:
        u, weights = _add_unclamped_starts(first, u, weights)
    rounds = MANY_SHAPES_ROUNDS if u.shape[1] > FEW_SHAPES else FEW_SHAPES_ROUNDS
    rounds = rounds if u.size or len(u) > 1 else ()  # without shapes there is nothing to choose
    corrections = None
    total = len(rounds) + len(problems)
    # All starts take a few steps, the best of them a few more, and so on
    for number, (count, steps) in enumerate(rounds):
        report(number, total)
        search = levenberg_marquardt(
            first.expand_loss, u, weights, first.weight_limits, steps, corrections=corrections
        )
        evaluations += search.evaluations
        rows = search.find_best_ends(count)
        ends, corrections = search.ends.select_points(rows), search.corrections[rows]
        u, weights = ends.u, ends.weights
    if rounds:
        revived = revive_zero_weights(first, ends.select_points([0]), starts)
        u, weights = (np.concatenate(parts) for parts in zip((u, weights), revived, strict=True))
        new = np.zeros((len(u) - len(rows), *search.corrections.shape[1:]))
        corrections = np.concatenate([search.corrections[rows], new])
    for number, problem in enumerate(problems):
        report(len(rounds) + number, total)
        if number:
            rows = search.find_best_ends(FINALISTS)
            error = search.ends.error
            rows = rows[error[rows] <= (1 + CLOSE) * error[rows[0]]]
            ends, corrections = search.ends.select_points(rows), search.corrections[rows]
            u, weights = ends.u, ends.weights
        # A model clamped at 0 takes many steps along kinks of the loss; on a part they cost less
        tight = MANY_SAMPLES_FACTOR * tolerance
        loose = tight if problem.clamped else max(LOOSE, tight)
        limit = loose if problem is not last else tight if number else tolerance
        part = problems[number - 1] if number else None
        search, count = _search_problem(problem, part, u, weights, corrections, iterations, limit)
        evaluations += count
    report(total, total)
    best = search.find_best_ends(FINALISTS)
    return search.ends.select_points(best), search.converged[best], evaluations


def _add_unclamped_starts(problem: Problem, u: FloatArray, weights: FloatArray) -> list[FloatArray]:
    """Return the starts `u`, `weights` and further ones where less of the model is clamped at 0.

    A search may stall where much of the model is negative and clamped. The further starts come from
    a search with a loss that continues below 0, and from other weights.
    """
    extended = Problem(problem.model, problem.samples, problem.loss, problem.space, extended=True)
    ends = levenberg_marquardt(
        extended.expand_loss, u, weights, problem.weight_limits, LARGEST_STEPS
    ).ends
    evenly = problem.estimate_weights(u, evenly=True)
    starts = [(u, weights), (ends.u, ends.weights), (u, evenly), (u, (evenly + weights) / 2)]
    starts.append(((u + ends.u) / 2, (weights + ends.weights) / 2))
    return [np.concatenate(parts) for parts in zip(*starts, strict=True)]


def _search_problem(
    problem: Problem,
    part: Problem | None,
    u: FloatArray,
    weights: FloatArray,
    corrections: FloatArray | None,
    iterations: int,
    tolerance: float,
) -> tuple[Search, int]:
    """Search for the least squared loss; return the `Search` and the number of evaluations.

    `u`, `weights`, `corrections`: start points, as in `levenberg_marquardt`; `part`: None, or the
    problem on a part of the samples whose ends are the start points.
    """
    evaluations, damping = 0, 1e-4
    if part is not None:
        # The Hessian of a part is nearly the Hessian of all samples, and takes less time
        expand, damping = _borrow_hessian_from_part(problem, part), 1e-7
        search = levenberg_marquardt(
            *(expand, u, weights, problem.weight_limits, FEW_STEPS, tolerance, damping, corrections)
        )
        if search.converged.all():
            return search, search.evaluations
        u, weights, evaluations = search.ends.u, search.ends.weights, search.evaluations
        corrections = search.corrections
    search = levenberg_marquardt(
        *(problem.expand_loss, u, weights, problem.weight_limits),
        *(iterations, tolerance, damping, corrections),
    )
    return search, evaluations + search.evaluations


def _borrow_hessian_from_part(
    whole: Problem, part: Problem
) -> Callable[[FloatArray, FloatArray], Expansion]:
    """Return a function like `whole.expand_loss` that takes the Hessian from a part of the samples.

    It saves time, because a Hessian takes longer than the squared loss and its gradient.
    """

    def expand_with_part_hessian(u: FloatArray, weights: FloatArray) -> Expansion:
        """Return the `Expansion` of the whole problem with the Hessian of its part."""
        expansion = whole.expand_loss(u, weights, curvature=False)
        near = part.expand_at_weights(u, weights)
        return replace(expansion, hessian=near.hessian, gram=near.gram)

    return expand_with_part_hessian
