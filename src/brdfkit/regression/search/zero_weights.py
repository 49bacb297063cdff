"""Gives a new start to lobes whose weight became 0 in a search.

The squared loss E² does not depend on the shape parameters of a lobe without weight, so a search
never changes them again. With other shape parameters the lobe might lower E²; the derivative of E²
by the weight of the lobe shows whether it would.
"""

import itertools

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.regression.problem.columns import Columns
from brdfkit.regression.problem.expansion import Expansion
from brdfkit.regression.problem.problem import Problem

# Largest number of new start points for each lobe, and the smallest share of E² that they must gain
LARGEST_COUNT, SMALLEST_GAIN = 4, 1e-7


def revive_zero_weights(problem: Problem, end: Expansion, starts: FloatArray) -> list[FloatArray]:
    """Return start points [u, weights] at which lobes that lost their weight have some again.

    These are the points where the squared loss E² falls most; there are none if no lobe would lower
    it. `end`: expansion of E² about the end of the search; `starts` (count, shapes): coordinates to
    try for the shape parameters of a lobe, in addition to the corners of their bounds.
    """
    points = [(end.u[:0], end.weights[:0])]
    for lobe in np.flatnonzero((end.weights[0] == 0).all(axis=0) & (problem.weight_limits[0] == 0)):
        shapes = _find_unshared_shapes(problem.columns, int(lobe))
        if not shapes:
            continue
        corners = np.array(list(itertools.product((0.0, 1.0), repeat=len(shapes))))
        own = np.concatenate([starts[:, shapes], corners])
        u = np.repeat(end.u, len(own), axis=0)
        u[:, shapes] = own
        weights = np.repeat(end.weights, len(own), axis=0)
        here = problem.expand_at_weights(u, weights)
        slope, bend = here.moment[:, :, lobe], here.gram[:, :, lobe, lobe]
        best = np.maximum(-slope, 0) / np.maximum(bend, 1e-300)
        best = np.minimum(best, problem.weight_limits[1, lobe])
        gain = -(slope * best).sum(axis=1)
        weights[:, :, lobe] = best
        order = np.argsort(-gain, kind="stable")[:LARGEST_COUNT]
        order = order[gain[order] > SMALLEST_GAIN * end.error[0]]
        points.append((u[order], weights[order]))
    return [np.concatenate(parts) for parts in zip(*points, strict=True)]


def _find_unshared_shapes(columns: Columns, lobe: int) -> list[int]:
    """Return the indices of those searched shape parameters that only this lobe depends on."""
    users: dict[int, set[int]] = {}
    for value, shape in columns.slopes:
        lobe_or_fixed = columns.lobes[value] if columns.powers[value] else -1
        users.setdefault(shape, set()).add(lobe_or_fixed)
    return [shape for shape, lobes in users.items() if lobes == {lobe}]
