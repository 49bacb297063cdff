"""The window of a volume's values, from the faintest matter to the brightest."""

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray
from brdfkit.volumes.transfer.transfer_function import RANGE_SHARES, WINDOW_SHARES, TransferFunction

SAMPLED_VOXELS = 2_000_000  # at most, evenly spread
PARTS = 256  # of the histogram in which the background is found
MIN_VOXELS = 1000  # fewer have no reliable histogram
OUTLIERS = 0.1  # percentile at either end beyond which voxels are ignored
# A background is a peak below the first share of the range, and ends below the second
PEAK, FOOT = 0.15, 0.4
FALL = 0.25  # share of the peak's height below which the background ends
FIRST, LAST = 2.0, 99.0  # percentiles of the matter


def find_window(values: AnyArray) -> tuple[float, float]:
    """Return (low, high) of `values` (nz, ny, nx): the background is below, few voxels are above.

    `low` is halfway from the end of the background to the faintest matter, so that matter is above
    it even if it has only one value.

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


def scale_to_values(transfer: TransferFunction, values: AnyArray) -> TransferFunction:
    """Scale a transfer function over shares to `values` (nz, ny, nx); keep any other as it is."""
    low, high = float(values.min()), float(values.max())
    if low == high or transfer.value_unit not in (WINDOW_SHARES, RANGE_SHARES):
        return transfer
    if transfer.value_unit == WINDOW_SHARES:
        low, high = find_window(values)
    return transfer.scaled_to(low, high)


def sample_values(values: AnyArray) -> FloatArray:
    """Return at most SAMPLED_VOXELS of the `values` (nz, ny, nx), evenly spread, as floats (n,)."""
    step = -(-values.size // SAMPLED_VOXELS)
    return values.reshape(-1)[::step].astype(float)


def split_background(values: FloatArray) -> tuple[float, FloatArray]:
    """Return the largest value of the background, and the `values` (n,) of matter.

    The background is the peak of the lowest values, such as air. It ends where the histogram is
    farthest below the line from the peak to the largest value [Zack et al. 1977]. Without such a
    peak all is matter. Outliers belong to neither.
    """
    low, high = np.percentile(values, [OUTLIERS, 100 - OUTLIERS])
    if low == high:  # nearly all is background
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
