"""Reduces the data of a fit, so that many start points can be compared quickly.

Many samples are reduced to a part of them, and the channels of a spectrum to a few bands.
"""

from dataclasses import replace

import numpy as np

from brdfkit.core.array_types import FloatArray, IntArray
from brdfkit.core.geometry.directions import cos_theta_h
from brdfkit.model.samples import Samples

# A spectrum is averaged to this number of channels
BANDS = 4


def average_to_bands(samples: Samples) -> Samples:
    """Return samples with a few channels, each the mean of neighbouring channels."""
    bands = np.array_split(samples.values, BANDS, axis=1)
    return replace(samples, values=np.stack([band.mean(axis=1) for band in bands], axis=1))


def draw_subset(
    samples: Samples, influence: FloatArray, size: int, rng: np.random.Generator
) -> tuple[Samples, IntArray]:
    """Draw about `size` of the `samples`, and return them with their indices.

    Half of them are drawn uniformly, half in proportion to their `influence` (n,) on the fit, so
    that a highlight keeps its influence even if few samples show it. They are drawn at even steps
    in the order of θ_h, the angle of the half vector, from a random start by the generator `rng`.
    The weights of the drawn samples grow to stand for all.
    """
    n = len(influence)
    share = 0.5 * influence
    share /= influence.sum() or 1.0
    share += 0.5 / n
    share /= share.sum()
    order = _sort_by_theta_h(samples)
    heights = np.cumsum(share if order is None else share[order])
    steps = (np.arange(size) + rng.random()) / size * heights[-1]
    rows, counts = np.unique(np.searchsorted(heights, steps), return_counts=True)
    rows = rows if order is None else order[rows]
    part = samples.at(rows)
    return replace(part, weight=part.weight * counts / (size * share[rows])), rows


def _sort_by_theta_h(samples: Samples) -> IntArray | None:
    """Return the indices that sort samples by θ_h, the angle of the half vector to the normal.

    Return None if they are already sorted, like the samples of a table.
    """
    first = samples.half_vector_starts  # one sample for each half vector shows the order
    if first is not None and _is_decreasing(cos_theta_h(samples.wi[first], samples.wo[first])):
        return None
    cosine = cos_theta_h(samples.wi, samples.wo)
    return None if _is_decreasing(cosine) else np.argsort(-cosine, kind="stable")


def _is_decreasing(cosine: FloatArray) -> bool:
    """Return whether the numbers (n,) never increase, except by rounding errors."""
    return np.diff(cosine).max(initial=0) <= 1e-12
