"""Histograms of a volume's values, and of values and gradient magnitudes, as numbers and text."""

from collections.abc import Iterator

import numpy as np

from brdfkit.core.array_types import AnyArray, IntArray
from brdfkit.volumes.volume import Volume

PARTS = 48  # number of equal bins over the range of values
STEPS = 24  # number of equal bins over the range of gradient magnitudes
SAMPLED_VOXELS = 2_000_000  # largest number of voxels in the joint histogram, evenly spread
FEW_VALUES = 64  # a volume with at most so many different whole numbers may contain labels


def count_voxels_by_value(volume: Volume) -> IntArray:
    """Return the histogram of a volume's values: the numbers of voxels (PARTS,) in equal bins."""
    return np.histogram(volume.values, PARTS, _find_histogram_range(volume))[0]


def count_voxels_by_gradient(volume: Volume, steepest: float) -> IntArray:
    """Return the joint histogram (STEPS, PARTS) of gradient magnitudes and values.

    The bins of gradient magnitudes reach from 0 to `steepest`, the largest one.
    """
    step = -(-volume.values.size // SAMPLED_VOXELS)
    gradients, values = volume.gradient_magnitude.ravel()[::step], volume.values.ravel()[::step]
    ends = (0, steepest or 1), _find_histogram_range(volume)
    return np.histogram2d(gradients, values, (STEPS, PARTS), ends)[0].astype(int)


def count_different_values(values: AnyArray) -> int:
    """Count the different values of voxels; return 0 if they are not of integer type."""
    if values.dtype.kind == "f":
        return 0
    low, high = int(values.min()), int(values.max())
    if high - low > 2**24:
        return len(np.unique(values))
    occurs = np.zeros(high - low + 1, bool)
    occurs[values.ravel().astype(np.int64) - low] = True
    return int(occurs.sum())


def format_bars(numbers: AnyArray) -> str:
    """Draw numbers as a bar chart of text, with logarithmic heights; 0 is a blank.

    >>> format_bars(np.array([0, 1, 10, 100]))
    ' ▂▅█'
    """
    return "".join(_choose_letters(numbers, " ▁▂▃▄▅▆▇█"))


def format_shades(numbers: AnyArray) -> str:
    """Draw numbers as a line of shaded letters, on a logarithmic scale; 0 is a blank."""
    return "".join(_choose_letters(numbers, " ░▒▓█"))


def _choose_letters(numbers: AnyArray, letters: str) -> Iterator[str]:
    """Yield a letter for each number, from the first letter for 0 to the last for the largest.

    In between, letters are chosen by the logarithm of the number.
    """
    height = np.log1p(numbers) / max(np.log1p(np.max(numbers)), 1e-9)
    return (letters[int(i)] for i in np.ceil(height * (len(letters) - 1)))


def _find_histogram_range(volume: Volume) -> tuple[float, float]:
    """Return the range (low, high) of a histogram of values; width 1 if all values are equal."""
    low, high = volume.range
    return (low, high) if low < high else (low - 0.5, high + 0.5)
