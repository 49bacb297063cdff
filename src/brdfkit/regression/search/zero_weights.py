"""Revives lobes whose weight became 0 in a search.

E² no longer depends on the shape parameters of such a lobe, so the search stalls there. With other
shapes the lobe might lower E²; the derivative of E² by its weights says whether it would.
"""

import itertools

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.regression.problem.columns import Columns
from brdfkit.regression.problem.expansion import Expansion
from brdfkit.regression.problem.problem import Problem

# The largest number of points for each lobe, and the smallest share of E² that it should gain
LARGEST_COUNT, SMALLEST_GAIN = 4, 1e-7


def revive_zero_weights(problem: Problem, end: Expansion, starts: FloatArray) -> list[FloatArray]:
    """Return points (u, weights) at which a lobe has weight that has none at `end`.

    `end`: an `Expansion` about one point; `starts` (count, shapes): coordinates to try for the
    shapes of the lobe, beside the ends of their bounds. The points are those at which E² would fall
    most; there are none if it would not fall.
    """
    points = [(end.u[:0], end.weights[:0])]
    for lobe in np.flatnonzero((end.weights[0] == 0).all(axis=0) & (problem.least == 0)):
        shapes = _find_own_shapes(problem.columns, int(lobe))
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
        gain = -(slope * best).sum(axis=1)
        weights[:, :, lobe] = best
        order = np.argsort(-gain, kind="stable")[:LARGEST_COUNT]
        order = order[gain[order] > SMALLEST_GAIN * end.error[0]]
        points.append((u[order], weights[order]))
    return [np.concatenate(parts) for parts in zip(*points, strict=True)]


def _find_own_shapes(columns: Columns, lobe: int) -> list[int]:
    """Return the indices of the searched shape parameters that no other lobe has."""
    users: dict[int, set[int]] = {}
    for value, shape in columns.slopes:
        users.setdefault(shape, set()).add(columns.lobes[value])
    return [shape for shape, lobes in users.items() if lobes == {lobe}]
