"""Chooses the noise of measured values: stated, by standard errors, or by repeated directions."""

import numpy as np

from brdfkit.core.arguments import to_number
from brdfkit.core.array_types import AnyArray, FloatArray
from brdfkit.core.geometry.directions import group_equal_pairs
from brdfkit.materials.completion.observations import LEAST_SHARE
from brdfkit.materials.completion.prior_cells import compute_cosine
from brdfkit.materials.measured.evidence import OFFSET

DEFAULT_NOISE = 0.05  # relative standard deviation of a value, where nothing is known
LEAST_NOISE = 0.002  # no instrument is better
FEWEST_REPEATS = 3  # repeated values from which a noise is estimated


def choose_noise(
    wi: AnyArray, wo: AnyArray, values: AnyArray, errors: AnyArray | None, noise: float | None
) -> tuple[FloatArray | float, str]:
    """Return the relative noise of `values` (n, channels), and words that say where it is from.

    A stated `noise` comes first, then standard `errors`, then the scatter of repeated directions.
    """
    if noise is not None:
        stated = to_number("noise", noise, above=0, most=1)
        return max(stated, LEAST_NOISE), f"{stated:.2g} of each, as stated"
    if errors is not None:
        relative = np.clip(errors / np.maximum(values, 1e-9), LEAST_NOISE, 10.0)
        return relative, f"{np.median(relative):.2g} in the median, by their standard errors"
    repeated = estimate_repeatability(wi, wo, values)
    if repeated is not None:
        return max(repeated, LEAST_NOISE), f"{repeated:.2g}, by the scatter of repeated directions"
    return DEFAULT_NOISE, f"{DEFAULT_NOISE:g}, which is assumed"


def estimate_repeatability(wi: AnyArray, wo: AnyArray, values: AnyArray) -> float | None:
    """Return the relative standard deviation of values at equal directions, or None.

    Dark values count little, by the share of f in f + e / c, and negative ones as 0. Where all
    repeated values are equal, they are copies, and tell nothing.
    """
    group, counts = group_equal_pairs(wi, wo)
    if (counts - 1).sum() < FEWEST_REPEATS:
        return None
    values = np.maximum(values, 0)
    sums = np.stack([np.bincount(group, column) for column in values.T], axis=1)
    means = (sums / counts[:, None])[group]
    offset = (OFFSET / compute_cosine(wi, wo))[:, None]
    scatter = np.sum(((values - means) / (means + offset)) ** 2)
    share = np.maximum(means / (means + offset), LEAST_SHARE)
    freedom = np.sum(share**2 * ((counts - 1) / counts)[group][:, None])
    return float(np.sqrt(scatter / freedom)) if scatter > 1e-12 * freedom else None
