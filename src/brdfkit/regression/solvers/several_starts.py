"""A local search from several starts, on ever more of the samples."""

import numpy as np

from brdfkit.regression.search.multistart import CLOSE, FINALISTS
from brdfkit.regression.solvers.objective import End

# Relative difference of E² below which two ends are one
SAME = 1e-6
# An end as near to a bound is put on it, where this raises E² by less than such a share
NEAR, EQUAL = 1e-4, 1e-10


def descend(objective, minimise, points):
    """The best `End` of the local searches from `points` (count, n).

    `minimise(objective, z)` is the `End` of a search from one point. All points are followed on the
    smallest part of the samples, the best ends of these on the next one, and so on.
    """
    stages = objective.stages()
    for number, stage in enumerate(stages):
        objective.report(number, len(stages))
        ends = [minimise(stage, z) for z in points]
        if objective.constraints:
            ends = objective.constraints.keep_met(ends)
        ends.sort(key=lambda end: end.error)
        points = [end.point for end in _differing(ends) if end.error <= (1 + CLOSE) * ends[0].error]
        points = points[:FINALISTS]
    objective.report(len(stages), len(stages))
    return _snap(objective, ends[0])


def _differing(ends):
    """The ends, in the order of their E², that differ in it."""
    errors = np.array([end.error for end in ends])
    new = np.diff(errors, prepend=-1) > SAME * errors
    return [end for end, is_new in zip(ends, new, strict=True) if is_new]


def _snap(objective, end):
    """The `End` on those bounds that it nearly reached: some searches stay within them."""
    low, high = objective.low, objective.high
    near = (end.point - low < NEAR) | (high - end.point < NEAR)
    bound = np.where(end.point - low < NEAR, low, high)
    (numbers,) = np.nonzero(near & (end.point != bound))
    each = np.tile(end.point, (len(numbers), 1))
    each[range(len(numbers)), numbers] = bound[numbers]
    limit = end.error * (1 + EQUAL)
    numbers = numbers[objective.error(each) <= limit] if len(numbers) else numbers
    point = end.point.copy()
    point[numbers] = bound[numbers]
    error = float(objective.error(point)[0])
    if error > limit or (objective.constraints and not objective.constraints.met(point)):
        return end
    return End(point, error, end.message)


def best_starts(objective, count):
    """The `count` starts with the least E² on the smallest part."""
    stage = objective.stages()[0]
    order = np.argsort(stage.error(stage.starts), kind="stable")
    return stage.starts[order[:count]]
