"""How a projection spreads depth: after it against before it [Ergun 2008, Figure 4.1]."""

import numpy as np


def depth_curve(projection, corners, count=1000, seed=0):
    """How far light has come (count,), and its depth on the map (count,), at random points.

    projection : a `Projection`.
    corners : (n, 3), of the convex body that has the points.
    """
    points = np.random.default_rng(seed).dirichlet(np.full(len(corners), 0.3), count) @ corners
    return projection.light.way(*points.T), projection.to_map(*points.T)[2]


def unevenness(before, after):
    """The share of the spread of depths, in [0, 1], that is no straight line of those before.

    0 if equal lengths along the light have equal depths all over the map.
    """
    line = np.polynomial.Polynomial.fit(before, after, 1)
    return np.std(after - line(before)) / np.std(after)
