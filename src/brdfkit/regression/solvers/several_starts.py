"""Runs a solver's local search from several start points, on growing parts of the samples."""

from collections.abc import Callable, Iterable

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.regression.search.multistart import CLOSE, FINALISTS
from brdfkit.regression.solvers.objective import End, Objective

# Two ends of searches count as one if their squared losses E² differ by a smaller share
SAME_END = 1e-6
# An end within this distance of a bound is moved onto the bound if E² grows by less than this share
BOUND_DISTANCE, EQUAL_ERROR = 1e-4, 1e-10


def search_in_stages(
    objective: Objective,
    minimise: Callable[[Objective, FloatArray], End],
    points: Iterable[FloatArray],
) -> End:
    """Search from several start `points` (count, n) in stages, and return the best `End`.

    All points are searched on the smallest part of the samples, the best ends on the next larger
    part, and so on. `minimise(objective, z)`: a function that searches from one point z (n,).
    """
    stages = objective.stages()
    for number, stage in enumerate(stages):
        objective.report(number, len(stages))
        ends = [minimise(stage, z) for z in points]
        if objective.constraints:
            ends = objective.constraints.keep_valid_ends(ends)
        ends.sort(key=lambda end: end.error)
        limit = (1 + CLOSE) * ends[0].error
        points = [end.point for end in _drop_equal_ends(ends) if end.error <= limit]
        points = points[:FINALISTS]
    objective.report(len(stages), len(stages))
    return _move_to_bounds(objective, ends[0])


def _drop_equal_ends(ends: list[End]) -> list[End]:
    """Return the `ends`, sorted by squared loss, without repetitions of the same loss."""
    errors = np.array([end.error for end in ends])
    new = np.diff(errors, prepend=-1) > SAME_END * errors
    return [end for end, is_new in zip(ends, new, strict=True) if is_new]


def _move_to_bounds(objective: Objective, end: End) -> End:
    """Return an `End` moved onto the bounds that it nearly reached.

    Some searches stay inside the bounds and never reach them exactly.
    """
    low, high = objective.low, objective.high
    near = (end.point - low < BOUND_DISTANCE) | (high - end.point < BOUND_DISTANCE)
    bound = np.where(end.point - low < BOUND_DISTANCE, low, high)
    (numbers,) = np.nonzero(near & (end.point != bound))
    each = np.tile(end.point, (len(numbers), 1))
    each[range(len(numbers)), numbers] = bound[numbers]
    limit = end.error * (1 + EQUAL_ERROR)
    numbers = numbers[objective.error(each) <= limit] if len(numbers) else numbers
    point = end.point.copy()
    point[numbers] = bound[numbers]
    error = float(objective.error(point)[0])
    if error > limit or (objective.constraints and not objective.constraints.are_met(point)):
        return end
    return End(point, error, end.message)


def find_best_starts(objective: Objective, count: int) -> FloatArray:
    """Return the `count` start points (count, n) with the least loss on the smallest part."""
    stage = objective.stages()[0]
    order = np.argsort(stage.error(stage.starts), kind="stable")
    return stage.starts[order[:count]]
