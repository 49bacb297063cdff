"""The starting points of a fit's search: the defaults, and points spread over the bounds."""

from functools import lru_cache

import numpy as np


def usual_starts(shapes):
    """How many points a search over so many shape parameters begins at."""
    return max(1, min(16 * shapes, 96))


def start_points(space, default, count, seed):
    """Start points (count, parameters), as coordinates: `default`, then points that Halton's
    sequence spreads over the bounds."""
    count = count if len(default) else 1
    return np.vstack([default, *_spread(len(default), count - 1, seed)])


@lru_cache
def _spread(dimensions, count, seed):
    """Points (count, dimensions) of Halton's sequence, scrambled by `seed`."""
    from scipy.stats import qmc

    return qmc.Halton(dimensions, rng=seed).random(count) if count and dimensions else ()
