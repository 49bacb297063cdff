"""Lobes that a search left black: E² does not tell their shapes any more, and the search rests.

With other shapes a black lobe might lower E²: whether it does is seen by the derivative of E² by
its weights.
"""

import itertools

import numpy as np

# How many points are gone on from, at most, and the least share of E² that a lobe should promise
MOST, LEAST = 4, 1e-7


def light_up(problem, end, starts):
    """Points (u, weights) at which one black lobe of an `Expansion` about one point shines.

    Its shapes are some of the `starts` (count, shapes), or ends of their bounds: those by which E²
    would fall most. There are no points where it would not fall.
    """
    found = [(end.u[:0], end.weights[:0])]
    for lobe in np.flatnonzero((end.weights[0] == 0).all(axis=0) & (problem.least == 0)):
        shapes = _own_shapes(problem.columns, lobe)
        if not shapes:
            continue
        corners = np.array(list(itertools.product((0.0, 1.0), repeat=len(shapes))))
        own = np.concatenate([starts[:, shapes], corners])
        u = np.repeat(end.u, len(own), axis=0)
        u[:, shapes] = own
        weights = np.repeat(end.weights, len(own), axis=0)
        here = problem.expand_here(u, weights)
        slope, bend = here.moment[:, :, lobe], here.gram[:, :, lobe, lobe]
        best = np.maximum(-slope, 0) / np.maximum(bend, 1e-300)
        gain = -(slope * best).sum(axis=1)
        weights[:, :, lobe] = best
        order = np.argsort(-gain, kind="stable")[:MOST]
        order = order[gain[order] > LEAST * end.error[0]]
        found.append((u[order], weights[order]))
    return [np.concatenate(parts) for parts in zip(*found, strict=True)]


def _own_shapes(columns, lobe):
    """The numbers of the searched shapes that no other lobe has."""
    users = {}
    for value, shape in columns.slopes:
        users.setdefault(shape, set()).add(columns.lobes[value])
    return [shape for shape, lobes in users.items() if lobes == {lobe}]
