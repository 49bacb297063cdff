"""Where the fit of a mixture begins: the thesis's guess, and random ones.

Expectation maximisation ends at the local maximum above its start; the best of several is taken.
"""

import numpy as np

from brdfkit.core.geometry.directions import to_angles
from brdfkit.lighting.spherical_gaussians import mixture


def cut_in_intervals(x, weights, n):
    """The thesis's guess: of θ and φ the one of the wider range, cut into n equal intervals.

    The samples `x` (m, 3) of each interval make one lobe. [Ergun 2015, section 8.3]
    """
    angle = max(to_angles(x), key=np.ptp)
    place = (angle - angle.min()) / max(np.ptp(angle), 1e-12) * n
    return mixture.of_clusters(x, weights, np.minimum(place.astype(int), n - 1), n)


def around_samples(x, weights, n, random):
    """n of the samples, drawn by their weights, each with the samples that are nearest to it."""
    drawn = random.choice(len(x), n, p=weights / weights.sum())
    return mixture.of_clusters(x, weights, (x @ x[drawn].T).argmax(axis=1), n)


def best_mixture(x, weights, n, restarts=4):
    """The likeliest mixture of n lobes from the thesis's guess and `restarts` random ones."""
    random = np.random.default_rng(0)
    starts = [cut_in_intervals(x, weights, n)]
    starts += [around_samples(x, weights, n, random) for _ in range(restarts)]
    fits = [mixture.fit(x, weights, start, steps=50) for start in starts]
    best, _ = max(fits, key=lambda found: found[1][-1])
    return mixture.fit(x, weights, best)[0]
