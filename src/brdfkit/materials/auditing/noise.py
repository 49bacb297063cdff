"""Estimates the noise of a measurement: the relative standard deviation of its values."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.materials.auditing.subsets import draw_valid_samples, thin_out_theta_h
from brdfkit.materials.auditing.symmetries import (
    compute_relative_differences,
    find_mirrored_pairs,
    find_repeated_pairs,
)
from brdfkit.materials.measured import Measured

TO_SIGMA = 1.4826  # standard deviation over median absolute deviation, for a normal distribution
FEWEST_DIFFERENCES = 20  # smallest number of differences from which the noise is estimated
NO_PAIR = "no direction pair was"
LEAST_NOISE = 1e-6  # smaller relative noise means that mirrored values are copies of each other


@dataclass(frozen=True)
class Noise:
    """The noise of a measurement, and how it was estimated.

    `relative`: standard deviation of a value over the value, for each channel, NaN where unknown;
    `method`: source of the estimate, or the reason why there is none, in words.
    """

    relative: tuple[float, ...]
    method: str


def estimate_noise(data: Measured) -> Noise:
    """Estimate the `Noise` of a measurement.

    Standard errors that it states are used. Otherwise the noise is estimated from differences that
    should be 0: between mirrored samples, or fourth differences along phi_d of a table.
    """
    if data.standard_error is not None:
        values = np.where(data.values == 0, np.nan, data.values)
        stated = np.abs(data.standard_error / values)[data.samples.valid]
        noise = _apply_to_channels(_compute_median, stated)
        return Noise(noise, "the standard error that the file states")
    if data.is_table:
        differences = _compute_fourth_differences(thin_out_theta_h(data.table))
        noise = _apply_to_channels(_compute_sigma, differences)
        return Noise(noise, "fourth differences along phi_d")
    unknown = (np.nan,) * len(data.channels)

    # Compare scattered samples that are repeated or mirror each other. Both values are noisy, so
    # their difference has √2 times the noise of one
    samples = draw_valid_samples(data)
    mirrored, values = find_mirrored_pairs(samples, data.anisotropic), samples.values
    rows = np.unique(np.concatenate([find_repeated_pairs(samples), mirrored]), axis=0)
    sigmas = tuple(
        _compute_sigma(compute_relative_differences(*channel[rows].T) / np.sqrt(2))
        for channel in values.T
    )
    if np.isnan(sigmas).all():
        few = f"fewer than {FEWEST_DIFFERENCES} direction pairs were" if len(rows) else NO_PAIR
        return Noise(unknown, f"not testable: {few} measured twice or mirrored")
    if np.nanmax(sigmas) < LEAST_NOISE:
        return Noise(unknown, "not testable: left and right are equal, probably copies")
    return Noise(sigmas, f"{len(rows):,} pairs of directions, measured twice or left and right")


def _compute_fourth_differences(f: FloatArray) -> FloatArray:
    """Return relative fourth differences (n, channels) along phi_d of a table's values `f`.

    They are divided by the values, and scaled so that their standard deviation is the relative
    noise of one value. Without noise they are only 10⁻⁵, whereas second differences reach 10⁻³ in a
    highlight.
    """
    before, behind = f[..., :-4, :] + f[..., 4:, :], f[..., 1:-3, :] + f[..., 3:-1, :]
    middle = f[..., 2:-2, :]
    with np.errstate(divide="ignore", invalid="ignore"):
        # The noise of a fourth difference is √70 times the noise of a value: the root of the sum of
        # the squares of its factors 1, -4, 6, -4, 1
        return ((before - 4 * behind + 6 * middle) / middle / np.sqrt(70)).reshape(-1, f.shape[-1])


def _apply_to_channels(
    statistic: Callable[[FloatArray], float], values: FloatArray
) -> tuple[float, ...]:
    """Return the `statistic`, such as the median, of each channel of `values` (n, channels)."""
    return tuple(statistic(column) for column in values.T)


def _compute_sigma(differences: FloatArray) -> float:
    """Return a robust estimate of the standard deviation of `differences`, from their median."""
    return TO_SIGMA * _compute_median(np.abs(differences))


def _compute_median(values: FloatArray) -> float:
    """Return the median of the finite `values`; NaN if there are fewer than 20."""
    values = values[np.isfinite(values)]
    return float(np.median(values)) if values.size >= FEWEST_DIFFERENCES else np.nan
