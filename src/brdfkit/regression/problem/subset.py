"""Draws parts of many samples, and averages many channels to bands, to compare starts quickly."""

from dataclasses import replace

import numpy as np

from brdfkit.core.array_types import FloatArray, IntArray
from brdfkit.core.geometry.directions import cos_theta_h
from brdfkit.model.samples import Samples

BANDS = 4


def average_to_bands(samples: Samples) -> Samples:
    """Return `Samples` with few channels, the means of neighbouring channels."""
    bands = np.array_split(samples.values, BANDS, axis=1)
    return replace(samples, values=np.stack([band.mean(axis=1) for band in bands], axis=1))


def draw_subset(
    samples: Samples, influence: FloatArray, size: int, rng: np.random.Generator
) -> tuple[Samples, IntArray]:
    """Draw about `size` of some `Samples`; return them, with larger weights, and their indices.

    Half of them are drawn uniformly, half in proportion to `influence` (n,). They are drawn at even
    steps in the order of theta_h, from a random start by the generator `rng`. So a highlight keeps
    its influence even if few samples show it.
    """
    n = len(influence)
    share = 0.5 / n + 0.5 * influence / (influence.sum() or 1.0)
    share /= share.sum()
    order = _sort_by_theta_h(samples)
    heights = np.cumsum(share if order is None else share[order])
    steps = (np.arange(size) + rng.random()) / size * heights[-1]
    rows, counts = np.unique(np.searchsorted(heights, steps), return_counts=True)
    rows = rows if order is None else order[rows]
    part = samples.at(rows)
    return replace(part, weight=part.weight * counts / (size * share[rows])), rows


def _sort_by_theta_h(samples: Samples) -> IntArray | None:
    """Return the indices that sort samples by theta_h; None if they are sorted, like a table's."""
    if samples.cells is not None:  # one sample for each half vector is enough
        first = np.flatnonzero(np.diff(samples.cells[0], prepend=-1))
        if _is_decreasing(cos_theta_h(samples.wi[first], samples.wo[first])):
            return None
    cosine = cos_theta_h(samples.wi, samples.wo)
    return None if _is_decreasing(cosine) else np.argsort(-cosine, kind="stable")


def _is_decreasing(cosine: FloatArray) -> bool:
    """Return whether the numbers (n,) never rise, except by rounding."""
    return np.diff(cosine).max(initial=0) <= 1e-12
