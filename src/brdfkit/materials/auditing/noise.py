"""Noise: the relative standard deviation of the values of a measurement."""

from dataclasses import dataclass

import numpy as np

from brdfkit.materials.auditing.spread import some_half_vectors, some_valid
from brdfkit.materials.auditing.symmetries import find_mirrored, relative_differences

TO_SIGMA = 1.4826  # standard deviation over median absolute deviation, for normal noise
LEAST = 20  # differences that an estimate needs
EQUAL = 1e-6  # two values that differ by less are one measurement, written twice


@dataclass(frozen=True)
class Noise:
    """`relative`: standard deviation of a value over the value, per channel, NaN where unknown.

    `method`: how it was estimated, in words.
    """

    relative: tuple[float, ...]
    method: str


def noise(data):
    """The `Noise` of a `Measured`: as its file states, else from differences that should be 0."""
    if data.standard_error is not None:
        values = np.where(data.values == 0, np.nan, data.values)
        stated = np.abs(data.standard_error / values)[data.samples.valid]
        return Noise(_per_channel(stated, _median), "the standard error that the file states")
    if data.is_table:
        differences = _fourth_differences(some_half_vectors(data.table))
        return Noise(_per_channel(differences, _sigma), "fourth differences along phi_d")
    unknown = (np.nan,) * len(data.channels)

    # samples of scattered ones that mirror each other; a difference has the noise of two values
    samples = some_valid(data)
    rows, values = find_mirrored(samples, data.anisotropic), samples.values
    differences = [
        relative_differences(*values[rows, c].T) / np.sqrt(2) for c in range(values.shape[1])
    ]
    sigmas = tuple(map(_sigma, differences))
    if np.isnan(sigmas).all():
        return Noise(unknown, "not testable: no direction pair was measured twice or mirrored")
    if np.nanmax(sigmas) < EQUAL:
        return Noise(unknown, "not testable: left and right are equal, probably copies")
    return Noise(sigmas, f"{len(rows):,} pairs of directions, measured twice or left and right")


def _fourth_differences(f):
    """Relative fourth differences (n, channels) of table values along phi_d.

    They are scaled to the standard deviation of one value. A smooth BRDF leaves 10⁻⁵ of its value;
    of second differences a highlight would leave 10⁻³.
    """
    before, behind = f[..., :-4, :] + f[..., 4:, :], f[..., 1:-3, :] + f[..., 3:-1, :]
    middle = f[..., 2:-2, :]
    with np.errstate(divide="ignore", invalid="ignore"):
        # √70: the root of the sum of the squared factors 1, 4, 6, 4, 1
        return ((before - 4 * behind + 6 * middle) / middle / np.sqrt(70)).reshape(-1, f.shape[-1])


def _per_channel(columns, statistic):
    """The `statistic` of each column of `columns` (n, channels), as a tuple."""
    return tuple(statistic(column) for column in columns.T)


def _sigma(differences):
    """The standard deviation of `differences`, unmoved by outliers."""
    return TO_SIGMA * _median(np.abs(differences))


def _median(values):
    """The median of the finite values; NaN of fewer than `LEAST`."""
    values = values[np.isfinite(values)]
    return float(np.median(values)) if values.size >= LEAST else np.nan
