"""Reduces the data of a fit, so that many start points can be compared quickly.

Many samples are reduced to a part of them, and the channels of a spectrum to a few bands.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

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


@dataclass(frozen=True, eq=False)
class Shares:
    """The probabilities with which samples are drawn, by the order of θ_h, their half angle.

    `of_samples` (n,): share of each sample; `order` (n,): indices that sort samples by θ_h, or None
    if they are sorted; `sums` (n,): sums of the shares in this order, up to each sample.
    """

    of_samples: FloatArray
    order: IntArray | None
    sums: FloatArray

    @classmethod
    def from_influence(cls, samples: Samples, influence: FloatArray) -> Shares:
        """Return shares that are half uniform and half in proportion to an `influence` (n,)."""
        share = 0.5 * influence
        share /= influence.sum() or 1.0
        share += 0.5 / len(share)
        share /= share.sum()
        order = _sort_by_theta_h(samples)
        return cls(share, order, np.cumsum(share if order is None else share[order]))


def draw_subset(
    samples: Samples, shares: Shares, size: int, rng: np.random.Generator
) -> tuple[Samples, IntArray]:
    """Draw about `size` of the `samples` with these `shares`; return them with their indices.

    A highlight keeps its influence on a fit even if few samples show it. The samples are drawn at
    even steps in the order of θ_h, the angle of the half vector, from a random start by the
    generator `rng`. The weights of the drawn samples grow to stand for all.
    """
    steps = (np.arange(size) + rng.random()) / size * shares.sums[-1]
    rows, counts = np.unique(np.searchsorted(shares.sums, steps), return_counts=True)
    rows = rows if shares.order is None else shares.order[rows]
    part = samples.at(rows)
    return replace(part, weight=part.weight * counts / (size * shares.of_samples[rows])), rows


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
