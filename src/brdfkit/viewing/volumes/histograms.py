"""Histograms of a volume's values and gradient magnitudes, behind the editor of the page."""

from __future__ import annotations

from weakref import WeakKeyDictionary

import numpy as np

from brdfkit.viewing.encoding import encode_png
from brdfkit.volumes import Volume

BINS, GRADIENT_BINS = 256, 128  # at most, of the joint histogram
FINE_BINS = 1024  # at most, of the histogram of values, whose parts the page can enlarge
COUNTED_VOXELS = 4_000_000  # evenly spread

# Kept, since every page of a volume shows them
_cache: WeakKeyDictionary[Volume, tuple[list[int], bytes]] = WeakKeyDictionary()


def make_histograms(
    volume: Volume, values: tuple[float, float], steepest: float
) -> tuple[list[int], bytes]:
    """Return the numbers of voxels over the range of `values`, and a PNG of the joint histogram.

    In the PNG, values increase to the right, gradient magnitudes upwards to the `steepest`.
    """
    if volume not in _cache:
        _cache[volume] = _count_voxels(volume, values, steepest)
    return _cache[volume]


def _count_voxels(
    volume: Volume, values: tuple[float, float], steepest: float
) -> tuple[list[int], bytes]:
    step = -(-volume.values.size // COUNTED_VOXELS)
    voxels = volume.values.reshape(-1)[::step]
    # Shares of the range, since the range of large values may be too narrow to be cut into bins
    shares = (voxels.astype(float) - values[0]) / (values[1] - values[0])
    gradients = volume.gradient_magnitude.reshape(-1)[::step]
    span = None if np.any(voxels % 1) else values[1] - values[0]
    count, ends = _choose_bins(span, BINS)
    joint = np.histogram2d(gradients, shares, (GRADIENT_BINS, count), ((0, steepest), ends))[0]
    shade = np.log1p(joint) / max(np.log1p(joint.max()), 1e-9)
    picture = encode_png(np.rint(255 * shade[::-1]).astype(np.uint8))
    count, ends = _choose_bins(span, FINE_BINS)
    return np.histogram(shares, count, ends)[0].tolist(), picture


def _choose_bins(span: float | None, most: int) -> tuple[int, tuple[float, float]]:
    """Return the number of bins, `most` or fewer, and their ends as shares of the range.

    Each bin of whole numbers, whose range is a `span`, contains as many of them, because bins of
    one and of two in turn would look like a comb. The span of other values is None.
    """
    if span is None:
        return most, (0.0, 1.0)
    width = -(-(int(span) + 1) // most)
    count = -(-(int(span) + 1) // width)
    return count, (-0.5 / span, (count * width - 0.5) / span)
