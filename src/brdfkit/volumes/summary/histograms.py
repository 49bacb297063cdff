"""Histograms of a volume's values and of values × gradient magnitudes, as numbers and as text."""

from collections.abc import Iterator

import numpy as np

from brdfkit.core.array_types import AnyArray, IntArray
from brdfkit.volumes.volume import Volume

PARTS = 48  # of the range of values
STEPS = 24  # of the range of gradient magnitudes
SAMPLED_VOXELS = 2_000_000  # of the joint histogram, evenly spread
FEW_VALUES = 64  # so few different whole numbers may be labels


def count_values(volume: Volume) -> IntArray:
    """Count the voxels (PARTS,) in equal parts of the range of values."""
    return np.histogram(volume.values, PARTS, _range(volume))[0]


def count_jointly(volume: Volume, steepest: float) -> IntArray:
    """Count the voxels (STEPS, PARTS) by gradient magnitude, up to `steepest`, and by value."""
    step = -(-volume.values.size // SAMPLED_VOXELS)
    gradients, values = volume.gradient_magnitude.ravel()[::step], volume.values.ravel()[::step]
    ends = (0, steepest or 1), _range(volume)
    return np.histogram2d(gradients, values, (STEPS, PARTS), ends)[0].astype(int)


def count_different(values: AnyArray) -> int:
    """Count the different values; return 0 unless they are of integer type."""
    if values.dtype.kind == "f":
        return 0
    low, high = int(values.min()), int(values.max())
    if high - low > 2**24:
        return len(np.unique(values))
    occurs = np.zeros(high - low + 1, bool)
    occurs[values.ravel().astype(np.int64) - low] = True
    return int(occurs.sum())


def bars(numbers: AnyArray) -> str:
    """Return numbers as bars of text, by their logarithm; a blank for 0.

    >>> bars(np.array([0, 1, 10, 100]))
    ' ▂▅█'
    """
    return "".join(_levels(numbers, " ▁▂▃▄▅▆▇█"))


def shades(numbers: AnyArray) -> str:
    """Return numbers as shades of text, by their logarithm; a blank for 0."""
    return "".join(_levels(numbers, " ░▒▓█"))


def _levels(numbers: AnyArray, letters: str) -> Iterator[str]:
    """Yield the letter of each number, from the first letter for 0 to the last for the largest."""
    height = np.log1p(numbers) / max(np.log1p(np.max(numbers)), 1e-9)
    return (letters[int(i)] for i in np.ceil(height * (len(letters) - 1)))


def _range(volume: Volume) -> tuple[float, float]:
    """Return the range of values; one value has a range of width 1."""
    low, high = volume.range
    return (low, high) if low < high else (low - 0.5, high + 0.5)
