"""Histograms of a volume's values and gradient magnitudes, behind the editor of the page."""

from __future__ import annotations

from weakref import WeakKeyDictionary

import numpy as np

from brdfkit.viewing.encoding import encode_png
from brdfkit.volumes import Volume

BINS, GRADIENT_BINS = 256, 128  # of the joint histogram
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
    ends = (0, steepest), (0, 1)
    joint = np.histogram2d(gradients, shares, (GRADIENT_BINS, BINS), ends)[0]
    shade = np.log1p(joint) / max(np.log1p(joint.max()), 1e-9)
    picture = encode_png(np.rint(255 * shade[::-1]).astype(np.uint8))
    # Bins of whole numbers are not finer than the numbers, because some would always be empty
    whole = not np.any(voxels % 1)
    count = min(max(int(values[1] - values[0]), BINS), FINE_BINS) if whole else FINE_BINS
    return np.histogram(shares, count, (0, 1))[0].tolist(), picture
