"""Defines `Comparison`, how far predicted photographs are from real ones."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from brdfkit.core.array_types import FloatArray


@dataclass(frozen=True)
class Comparison:
    """Relative errors of predicted photographs: medians, and 90th percentiles.

    median, high : over all pixels that count, of all photographs.
    adapted_median, adapted_high : the same if each prediction is multiplied by the factor that
        suits its photograph, whose exposure may not be known well.
    by_name : the median and the 90th percentile of each photograph, by its name.
    """

    median: float
    high: float
    adapted_median: float
    adapted_high: float
    by_name: dict[str, tuple[float, float]]

    @classmethod
    def collect(cls, pairs: dict[str, tuple[FloatArray, FloatArray]]) -> Comparison | None:
        """Return the comparison of predictions (n, 3) with the values (n, 3) of photographs.

        `pairs` has both by the photographs' names, for the pixels that count.
        """
        pairs = {name: pair for name, pair in pairs.items() if len(pair[0])}
        if not pairs:
            return None
        errors = {name: compute_relative_errors(*pair) for name, pair in pairs.items()}
        adapted = [
            compute_relative_errors(predicted * _find_factor(predicted, values), values)
            for predicted, values in pairs.values()
        ]
        return cls(
            *_find_quantiles(np.concatenate(list(errors.values()))),
            *_find_quantiles(np.concatenate(adapted)),
            {name: _find_quantiles(own) for name, own in errors.items()},
        )


def compute_relative_errors(predicted: FloatArray, values: FloatArray) -> FloatArray:
    """Return the differences of pixels, in the mean over the channels, relative to the values."""
    errors: FloatArray = np.abs(predicted - values).mean(axis=1) / values.mean(axis=1)
    return errors


def _find_factor(predicted: FloatArray, values: FloatArray) -> float:
    """Return the median ratio of a photograph's values to the predicted ones."""
    brightness = predicted.mean(axis=1)
    bright = brightness > 0
    if not bright.any():
        return 1.0
    return float(np.median(values.mean(axis=1)[bright] / brightness[bright]))


def _find_quantiles(values: FloatArray) -> tuple[float, float]:
    """Return the median and the 90th percentile."""
    median, high = np.quantile(values, (0.5, 0.9))
    return float(median), float(high)


def compute_angles(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return the angles (n,) [degrees] between unit vectors (n, 3); nan where one is unknown."""
    angles: FloatArray = np.degrees(np.arccos(np.clip((a * b).sum(axis=1), -1, 1)))
    return angles
