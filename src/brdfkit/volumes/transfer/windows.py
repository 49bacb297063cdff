"""The window of a volume: the range of values of its matter, without the background."""

import math

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray
from brdfkit.volumes.transfer.transfer_function import RANGE_SHARES, WINDOW_SHARES, TransferFunction

SAMPLED_VOXELS = 2_000_000  # largest number of voxels in a histogram, evenly spread
PARTS = 256  # number of bins of the histogram in which the background is found
MIN_VOXELS = 1000  # fewer voxels do not have a reliable histogram
OUTLIERS = 0.1  # percentile at either end beyond which voxels are ignored
# Shares of the range of values below which the background's peak lies, and its end
PEAK, FOOT = 0.15, 0.4
FALL = 0.25  # at the background's end the histogram is lower than this share of its peak
FIRST, LAST = 2.0, 99.0  # percentiles of the matter's values at the ends of the window


def find_window(values: AnyArray) -> tuple[float, float]:
    """Find the range (low, high) of the matter in a volume's `values` (nz, ny, nx).

    The background lies below, and a few bright voxels above. `low` is halfway from the end of the
    background to the faintest matter, so that matter of a single value still lies above it.

    >>> find_window(np.repeat([0.0, 100.0, 200.0], [9000, 500, 500]).reshape(100, 10, 10))
    (50.0, 200.0)
    """
    end, matter = split_background(sample_values(values))
    faintest, high = np.percentile(matter, [FIRST, LAST]).tolist()
    low = (end + faintest) / 2
    if low < high:
        return low, high
    low, high = float(values.min()), float(values.max())
    return (low, high) if low < high else (min(low, 0.0), max(high, 0.0))


def scale_transfer_to_values(transfer: TransferFunction, values: AnyArray) -> TransferFunction:
    """Scale a transfer function from shares, 0 to 1, to the range of a volume's `values`.

    Functions for data without a unit have WINDOW_SHARES or RANGE_SHARES as their `value_unit`;
    any other function is returned unchanged.
    """
    if transfer.value_unit not in (WINDOW_SHARES, RANGE_SHARES):
        return transfer
    low, high = float(values.min()), float(values.max())
    if low == high:
        return transfer
    if transfer.value_unit == WINDOW_SHARES:
        low, high = find_window(values)
    return transfer.scaled_to(low, high)


def sample_values(values: AnyArray) -> FloatArray:
    """Return at most SAMPLED_VOXELS of a volume's `values` (nz, ny, nx) as floats (n,)."""
    step = -(-values.size // SAMPLED_VOXELS)
    return values.reshape(-1)[::step].astype(float)


def find_upper_percentile(values: AnyArray, percent: float) -> float:
    """Return a percentile of `values` as `numpy.percentile`; it is quick if `percent` is near 100.

    Only the values above a bound are sorted. The bound is a percentile of a part of the values.
    """
    flat = values.reshape(-1)
    bound = np.percentile(sample_values(values), max(2 * percent - 100, 0))
    upper = flat[flat >= bound]
    place = (flat.size - 1) * percent / 100 - (flat.size - upper.size)
    if place < 0:
        return float(np.percentile(flat, percent))
    k = math.floor(place)
    upper = np.partition(upper, [k, min(k + 1, upper.size - 1)])[k : k + 2].astype(float)
    return float(upper[0] + (place - k) * (upper[-1] - upper[0]))


def split_background(values: FloatArray) -> tuple[float, FloatArray]:
    """Split `values` (n,) into background and matter.

    Returns the largest value of the background, and the values (m,) of matter. The background, such
    as air, is the peak at the low end of the histogram. It ends where the histogram is farthest
    below the straight line from the peak to the largest value [Zack et al. 1977]. Without such a
    peak all values are matter; outliers are dropped.
    """
    low, high = np.percentile(values, [OUTLIERS, 100 - OUTLIERS])
    if low == high:  # nearly all voxels have one value, the background
        others = values[values != low]
        return float(low), others if len(others) else values
    counts, edges = np.histogram(values, PARTS, (low, high))
    peak = int(counts.argmax())
    heights = counts[peak:] / counts[peak]
    line = np.linspace(1, 0, len(heights))
    foot = peak + int(np.argmax(line - heights))
    is_low = peak < PEAK * PARTS and foot < FOOT * PARTS and heights[foot - peak] < FALL
    if not is_low or len(values) < MIN_VOXELS:
        return float(low), values[(values >= low) & (values <= high)]
    air = values < edges[foot]
    return float(values[air].max()), values[~air & (values <= high)]
