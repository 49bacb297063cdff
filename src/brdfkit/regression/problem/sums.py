"""Adds up samples for the squared loss E² and its derivatives, and finds the best weights.

"Columns" are the values of the model's lobes at the samples, and their derivatives with respect to
shape parameters.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.regression.problem.box_quadratic import minimise_in_box
from brdfkit.regression.problem.columns import Columns

# Columns are multiplied in parts of this many numbers, which fit into the processor's cache
PART_SIZE = 2**16
# From this number of columns on, products with themselves save time by their symmetry
MANY_COLUMNS = 16


@dataclass(eq=False)
class Sums:
    """Sums over samples from which the squared loss E² and its derivatives follow, at some points.

    T are the columns of the model at a sample, d is the difference of the loss, d' its derivative
    with respect to the model's value, and w the weight of the sample.

    `error`: Σ w d² (points,), which is E²; `moment`: Σ w d d' T (points, channels, columns);
    `gram`: Σ w d'² T Tᵀ (points, channels, columns, columns), or None.
    """

    error: np.ndarray
    moment: np.ndarray
    gram: Any

    @classmethod
    def make_zeros(cls, points: int, channels: int, columns: int, curvature: bool = True) -> Sums:
        """Return sums over no samples, to add samples to; `curvature`: whether to sum `gram`."""
        gram = np.zeros((points, channels, columns, columns)) if curvature else None
        return cls(np.zeros(points), np.zeros((points, channels, columns)), gram)

    def is_finite(self) -> bool:
        """Return whether the sums for the squared loss and its gradient are finite."""
        return bool(np.isfinite(self.error).all() and np.isfinite(self.moment).all())

    @np.errstate(invalid="ignore")  # callers use `is_finite`, and raise a clearer error
    def add_samples(
        self,
        columns: FloatArray,
        squares: FloatArray,
        moments: list[FloatArray],
        weights: list[FloatArray],
    ) -> None:
        """Add n samples to the sums, with the symbols that the class explains.

        `columns`: the columns T (points, columns, n); `squares`: w d², summed over channels,
        (points, n); `moments`, `weights`: w d d' and w d'², an array (points, n) for each channel,
        or one of `weights` for all channels.
        """
        points, count, n = columns.shape
        self.error += squares.sum(axis=1)
        step = max(PART_SIZE // (points * count), 64)
        for start in range(0, n, step):
            part = slice(start, start + step)
            T = columns[:, :, part]
            for c, moment in enumerate(moments):
                self.moment[:, c] += (T @ moment[:, part, None])[:, :, 0]
            if self.gram is None:
                continue
            for c, weight in enumerate(weights):
                own = slice(c, c + 1) if len(weights) > 1 else slice(None)
                self.gram[:, own] += _multiply_columns(T, weight[:, part])[:, None]


def _multiply_columns(T: FloatArray, weight: FloatArray) -> FloatArray:
    """Return the products T w Tᵀ (points, k, k) of k columns T (points, k, n), w (points, n)."""
    if T.shape[1] < MANY_COLUMNS or weight.min() < 0:
        return np.asarray((T * weight[:, None]) @ T.transpose(0, 2, 1))
    rooted = T * np.sqrt(weight)[:, None]
    return np.asarray(rooted @ rooted.transpose(0, 2, 1))  # BLAS computes half of it


def solve_weights(columns: Columns, sums: Sums, limits: FloatArray) -> FloatArray:
    """Return the lobes' weights (points, channels, lobes) that minimise the squared loss.

    `columns`: columns of the model; columns that are multiplied by a squared weight are ignored;
    `sums`: sums where all weights are 0; `limits` (2, lobes): lower and upper bounds of weights.
    """
    points, channels = sums.moment.shape[:2]
    lobes = int(columns.lobes.max()) + 1
    gram = sums.gram[:, :, :lobes, :lobes].reshape(-1, lobes, lobes)
    moment = sums.moment[:, :, :lobes].reshape(-1, lobes)
    return minimise_in_box(gram, moment, *limits).reshape(points, channels, lobes)


def move_sums_to_weights(columns: Columns, sums: Sums, weights: FloatArray) -> Sums:
    """Return the sums at other `weights` of the lobes without a pass over the samples.

    `sums`: sums where all weights are 0, under a loss that is linear in the model.
    """
    factors = weights[:, :, columns.lobes] ** columns.powers
    factors[:, :, columns.powers == 0] = 0  # lobes without a weight are in `sums` already
    values = len(columns.lobes)
    by_values = sums.gram[:, :, :, :values] @ factors[..., None]
    moment = sums.moment + by_values[..., 0]
    both = (sums.moment + moment)[:, :, :values] * factors
    return Sums(np.maximum(sums.error + both.sum(axis=(1, 2)), 0), moment, sums.gram)
