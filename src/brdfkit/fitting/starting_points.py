"""The starting points of a fit's search: the defaults, and points spread over the bounds."""

import numpy as np


def start_points(space, default, count, seed):
    """Start points (count, parameters), as coordinates: `default`, then points that Halton's
    sequence spreads over the bounds."""
    if count == 1:
        return default[None, :]
    from scipy.stats import qmc

    spread = qmc.Halton(len(default), rng=seed).random(count - 1)
    return np.vstack([default, spread])
