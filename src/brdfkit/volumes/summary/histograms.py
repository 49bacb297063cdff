"""Histograms of a volume: of its values, and of values × gradient magnitudes."""

import numpy as np

PARTS = 48  # of the range of values
STEPS = 24  # of the range of gradient magnitudes
MOST = 2_000_000  # voxels of the joint histogram, evenly spread
FEW = 64  # different whole numbers: they may be labels


def counts(volume):
    """How many voxels (PARTS,) are in each of equal parts of the range."""
    return np.histogram(volume.values, PARTS, _range(volume))[0]


def joint(volume, steepest):
    """How many voxels (STEPS, PARTS) have which gradient magnitude, up to `steepest`, and value."""
    step = -(-volume.values.size // MOST)
    gradients, values = volume.gradient_magnitude.ravel()[::step], volume.values.ravel()[::step]
    ends = (0, steepest or 1), _range(volume)
    return np.histogram2d(gradients, values, (STEPS, PARTS), ends)[0].astype(int)


def different(values):
    """How many different whole numbers there are; 0 of numbers that are not whole by type."""
    if values.dtype.kind == "f":
        return 0
    low, high = int(values.min()), int(values.max())
    if high - low > 2**24:
        return len(np.unique(values))
    seen = np.zeros(high - low + 1, bool)
    seen[values.ravel().astype(np.int64) - low] = True
    return int(seen.sum())


def bars(numbers):
    """Numbers as bars of text, by their logarithm; a blank for 0.

    >>> bars(np.array([0, 1, 10, 100]))
    ' ▂▅█'
    """
    return "".join(_levels(numbers, " ▁▂▃▄▅▆▇█"))


def shades(numbers):
    """Numbers as shades of text, by their logarithm; a blank for 0."""
    return "".join(_levels(numbers, " ░▒▓█"))


def _levels(numbers, letters):
    height = np.log1p(numbers) / max(np.log1p(np.max(numbers)), 1e-9)
    return (letters[int(i)] for i in np.ceil(height * (len(letters) - 1)))


def _range(volume):
    low, high = volume.range
    return (low, high) if low < high else (low - 0.5, high + 0.5)
