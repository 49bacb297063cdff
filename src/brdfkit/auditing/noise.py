"""How much the values of a measurement scatter."""

from dataclasses import dataclass

import numpy as np

from brdfkit.auditing.pairs import mirrored, relative

TO_SIGMA = 1.4826  # standard deviation over median absolute deviation, of normal noise
LEAST = 20  # differences, for an estimate
EQUAL = 1e-6  # below it two measurements are one, written twice


@dataclass(frozen=True)
class Noise:
    """Standard deviation of a value over the value, per channel, NaN where nothing tells it;
    and the `method` in words."""

    relative: tuple[float, ...]
    method: str


def noise(data):
    """The `Noise` of a `Measured`: as the file states it, or from differences that should be 0."""
    samples = data.samples
    values = samples.values[samples.valid]
    if data.standard_error is not None:
        stated = np.abs(data.standard_error[samples.valid] / np.where(values == 0, np.nan, values))
        return Noise(_each(stated, _median), "the standard error that the file states")
    if data.is_table:
        differences = _along_phi_d(data.table.values)
        return Noise(_each(differences, _sigma), "fourth differences along phi_d")
    unknown = (np.nan,) * len(data.channels)
    rows = mirrored(data)
    differences = [relative(*values[rows, c].T) / np.sqrt(2) for c in range(values.shape[1])]
    sigmas = tuple(map(_sigma, differences))
    if np.isnan(sigmas).all():
        return Noise(unknown, "not testable: nothing was measured twice or mirrored")
    if np.nanmax(sigmas) < EQUAL:
        return Noise(unknown, "not testable: left and right are equal, made so by somebody")
    return Noise(sigmas, "left against right of the plane of incidence")


def _along_phi_d(f):
    """Fourth differences over the value, scaled to the deviation of one value: a smooth function
    leaves 10⁻⁵ of itself, a second difference at a highlight 10⁻³."""
    before, behind = f[..., :-4, :] + f[..., 4:, :], f[..., 1:-3, :] + f[..., 3:-1, :]
    middle = f[..., 2:-2, :]
    with np.errstate(divide="ignore", invalid="ignore"):
        return ((before - 4 * behind + 6 * middle) / middle / np.sqrt(70)).reshape(-1, f.shape[-1])


def _each(columns, statistic):
    return tuple(statistic(column) for column in columns.T)


def _sigma(differences):
    return TO_SIGMA * _median(np.abs(differences))


def _median(values):
    values = values[np.isfinite(values)]
    return float(np.median(values)) if values.size >= LEAST else np.nan
