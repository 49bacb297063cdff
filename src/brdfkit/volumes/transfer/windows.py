"""The window of a volume's values: from where its matter begins to where it is brightest."""

import numpy as np

from brdfkit.volumes.transfer.transfer_function import RANGE_SHARES, WINDOW_SHARES

MOST = 2_000_000  # voxels that are looked at, evenly spread
PARTS = 256  # of the histogram by which the background is found
FEWEST = 1000  # voxels with a histogram that tells a background
OUTLIERS = 0.1  # percentile: a few voxels beyond it, at either end, count for nothing
# A background is a peak below this share of the range, that ends below that one
PEAK, FOOT = 0.15, 0.4
FALL = 0.25  # of the peak: the histogram is below it where the background ends
FIRST, LAST = 2.0, 99.0  # percentiles of the matter


def window(values):
    """(low, high) of `values` (nz, ny, nx): nothing of interest is below, hardly a voxel above.

    `low` is halfway from the end of the background to the least of the matter, so that the matter
    is above it also where it is all of one value.

    >>> window(np.repeat([0.0, 100.0, 200.0], [9000, 500, 500]).reshape(100, 10, 10))
    (50.0, 200.0)
    """
    end, found = background_and_matter(sample(values))
    least, high = np.percentile(found, [FIRST, LAST]).tolist()
    low = (end + least) / 2
    if low < high:
        return low, high
    low, high = float(values.min()), float(values.max())
    return (low, high) if low < high else (min(low, 0.0), max(high, 0.0))


def fitted(transfer, values):
    """A transfer function of shares for these `values` (nz, ny, nx); any other one as it is."""
    low, high = float(values.min()), float(values.max())
    if low == high or transfer.value_unit not in (WINDOW_SHARES, RANGE_SHARES):
        return transfer
    if transfer.value_unit == WINDOW_SHARES:
        low, high = window(values)
    return transfer.scaled_to(low, high)


def sample(values):
    """At most MOST of the `values` (nz, ny, nx), evenly spread, as floats (n,)."""
    step = -(-values.size // MOST)
    return values.reshape(-1)[::step].astype(float)


def background_and_matter(values):
    """The largest value of the background, and the `values` (n,) that are none and no outliers.

    The background is the peak of the lowest values, such as air. It ends where the histogram is
    farthest below the line from the peak to the largest value [Zack et al. 1977]. Without such a
    peak all is matter.
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
    if not is_low or len(values) < FEWEST:
        return float(low), values[(values >= low) & (values <= high)]
    air = values < edges[foot]
    return float(values[air].max()), values[~air & (values <= high)]
