"""Maps that are first a few texels large, then twice as fine and so on."""

import numpy as np

from brdfkit.inverse.photographs.search.restarts import propagated, restarted
from brdfkit.inverse.photographs.search.search import equations, search_each, search_together
from brdfkit.inverse.photographs.search.smoothness import noise_of, strengths
from brdfkit.inverse.photographs.search.starts import WIDTHS, rows

USUAL = 0.1  # by how much neighbours may differ on the way
COARSE = 4  # texels along a side of the first maps
SEARCHES = 5  # for the noise, at most
SETTLED = 0.7  # of the noise before
SWEEPS = 2  # of numbers handed on to neighbours


def coarse_to_fine(numbers, seen, report):
    """Yield (rows, noise, shape) of maps that are first a few texels large, then twice as fine and
    so on: a texel alone may mistake a highlight for its colour, a part of the sample less so."""
    side = 2 ** max(0, int(np.ceil(np.log2(max(seen.shape) / COARSE))))
    pooled = seen.pooled(side)
    tried = [
        search_each(numbers, rows(numbers, pooled, width), pooled, report=report)
        for width in WIDTHS
    ]
    errors = np.array([error for _, error in tried])
    best = errors.argmin(axis=0)
    x = np.array([x for x, _ in tried])[best, np.arange(len(best))]
    noise = noise_of(numbers, errors.min(axis=0), pooled)
    yield x, noise, pooled.shape
    while side > 1:
        side //= 2
        coarse, pooled = pooled.shape, seen.pooled(side)
        x = refined(x, coarse, pooled.shape)
        x, noise = settled(numbers, x, pooled, noise, report)
        strength = strengths(numbers, x, pooled, noise, USUAL)
        x = finish(numbers, x, pooled, strength, noise, report)
        noise = noise_of(numbers, equations(numbers, x, pooled, slopes=False).error, pooled)
        yield x, noise, pooled.shape


def settled(numbers, x, seen, noise, report):
    """(rows, noise): what coarser maps leave is no noise of finer ones, which it would smooth."""
    for _ in range(SEARCHES):
        strength = strengths(numbers, x, seen, noise, USUAL)
        x = search_together(numbers, x, seen, strength, report=report)
        before = noise
        noise = noise_of(numbers, equations(numbers, x, seen, slopes=False).error, seen)
        if noise > SETTLED * before:
            break
    return x, noise


def refined(x, coarse, fine):
    """Rows of maps of the shape `coarse` for those of `fine`, twice as many a side."""
    grid = np.repeat(np.repeat(x.reshape(*coarse, -1), 2, axis=0), 2, axis=1)
    return grid[: fine[0], : fine[1]].reshape(fine[0] * fine[1], -1)


def finish(numbers, x, seen, strength, noise, report):
    """Rows of the least squares together; texels that are not explained, or that their neighbours'
    numbers suit better, begin at others once more."""
    x = search_together(numbers, x, seen, strength, report=report)
    other = restarted(numbers, x, seen, noise, report)
    for _ in range(SWEEPS):
        other = propagated(numbers, other, seen, report)
    if (other != x).any():
        x = search_together(numbers, other, seen, strength, report=report)
    return x
