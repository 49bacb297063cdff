"""Parts of many samples, and bands of many channels, by which starts are compared."""

from dataclasses import replace

import numpy as np

from brdfkit.core.geometry.directions import cos_theta_h

BANDS = 4


def mix_bands(samples):
    """`Samples` with few channels, the means of neighbouring ones."""
    bands = np.array_split(samples.values, BANDS, axis=1)
    return replace(samples, values=np.stack([band.mean(axis=1) for band in bands], axis=1))


def draw_part(samples, influence, size, rng):
    """About `size` of some `Samples`, with larger weights that make up for the others, and their
    numbers.

    Half are drawn evenly, half in proportion to `influence` (n,), at even steps in the order of
    theta_h, beginning where the generator `rng` says: so a highlight is in the part as it is in the
    whole, however few samples show it.
    """
    n = len(influence)
    share = 0.5 / n + 0.5 * influence / (influence.sum() or 1.0)
    share /= share.sum()
    order = _order(samples)
    heights = np.cumsum(share if order is None else share[order])
    steps = (np.arange(size) + rng.random()) / size * heights[-1]
    rows, counts = np.unique(np.searchsorted(heights, steps), return_counts=True)
    rows = rows if order is None else order[rows]
    part = samples.at(rows)
    return replace(part, weight=part.weight * counts / (size * share[rows])), rows


def _order(samples):
    """The order of theta_h; None where the samples are in it, as a table's cells."""
    if samples.cells is not None:  # one of each half vector tells
        first = np.flatnonzero(np.diff(samples.cells[0], prepend=-1))
        if _falls(cos_theta_h(samples.wi[first], samples.wo[first])):
            return None
    cosine = cos_theta_h(samples.wi, samples.wo)
    return None if _falls(cosine) else np.argsort(-cosine, kind="stable")


def _falls(cosine):
    return np.diff(cosine).max(initial=0) <= 1e-12
