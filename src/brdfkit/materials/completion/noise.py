"""Chooses the noise of measured values: stated, by standard errors, or by repeated directions."""

import numpy as np

from brdfkit.core.arguments import to_number
from brdfkit.core.array_types import AnyArray, FloatArray

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
    """Return the relative standard deviation of values at equal directions, or None."""
    pairs = np.concatenate([wi, wo], axis=1).round(6)
    _, group, counts = np.unique(pairs, axis=0, return_inverse=True, return_counts=True)
    group = group.ravel()
    freedom = int((counts - 1).sum())
    if freedom < FEWEST_REPEATS:
        return None
    sums = np.stack([np.bincount(group, column) for column in values.T], axis=1)
    means = (sums / counts[:, None])[group]
    relative = (values - means) / np.maximum(means, 1e-9)
    return float(np.sqrt(np.mean(np.sum(relative**2, axis=0)) / freedom))
