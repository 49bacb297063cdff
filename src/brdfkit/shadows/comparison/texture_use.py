"""Q1: how evenly what a camera sees is spread over its shadow maps [Ergun 2008, 3.2].

The places of the pixels' points in the maps fall into `BINS` × `BINS` cells each; h counts them.
The thesis takes the mean squared difference to a uniform histogram, and does not tell its unit.
Here counts are in units of their mean, h̄ = 1:

    d = mean (h - 1)²,    share used = 1 / (1 + d) = (Σ h)² / (cells · Σ h²)

so that points spread evenly over a quarter of a map have d = 3 and use a quarter of it.
"""

import numpy as np

BINS = 64  # along each side of a map: cells enough to tell where, points enough in each


def share_used(maps, bins=BINS):
    """The share of the maps that points use, in (0, 1]; nan where no point is on a map.

    maps : for each map, the places (n, 2) of points on it, in [0, 1]²; others do not count.

    >>> share_used([np.array([[0.2, 0.2], [0.7, 0.2]])], bins=2)
    0.5
    """
    counts = np.stack([np.histogram2d(*places.T, bins, [[0, 1]] * 2)[0] for places in maps])
    if not counts.any():
        return np.nan
    return float(counts.sum() ** 2 / (counts.size * np.square(counts).sum()))
