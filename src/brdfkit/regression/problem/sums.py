"""Sums over samples for E² and its derivatives, and the best weights that follow from them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.regression.problem.box_quadratic import minimise_in_box
from brdfkit.regression.problem.columns import Columns

# Columns are multiplied in parts of this many numbers, which stay in the processor's cache
PART_SIZE = 2**16


@dataclass(eq=False)
class Sums:
    """Sums over samples at several points.

    `error` Σ w d² (points,); `moment` Σ w d d' T (points, channels, columns); `gram`
    Σ w d'² T Tᵀ (points, channels, columns, columns), or None. T are the columns, d is the
    difference of the loss, d' its derivative by the model's value, and w the weight of a sample.
    """

    error: np.ndarray
    moment: np.ndarray
    gram: Any

    @classmethod
    def zeros(cls, points: int, channels: int, columns: int, curvature: bool = True) -> Sums:
        """Return sums over no samples."""
        gram = np.zeros((points, channels, columns, columns)) if curvature else None
        return cls(np.zeros(points), np.zeros((points, channels, columns)), gram)

    def is_finite(self) -> bool:
        """Return whether the errors and moments are finite."""
        return bool(np.isfinite(self.error).all() and np.isfinite(self.moment).all())

    @np.errstate(invalid="ignore")  # `is_finite` reports it
    def add_samples(
        self,
        columns: list[FloatArray],
        squares: FloatArray,
        moments: list[FloatArray],
        weights: list[FloatArray],
    ) -> None:
        """Add samples.

        `columns`: a list of T (points, n); `squares` Σ_c w d² (points, n); `moments` w d d' and
        `weights` w d'²: lists by channel of arrays (points, n).
        """
        points, n = squares.shape
        self.error += squares.sum(axis=1)
        step = max(PART_SIZE // (points * len(columns)), 64)
        for start in range(0, n, step):
            part = slice(start, start + step)
            T = np.stack([column[:, part] for column in columns], axis=1)
            for c, (moment, weight) in enumerate(zip(moments, weights, strict=True)):
                self.moment[:, c] += (T @ moment[:, part, None])[:, :, 0]
                if self.gram is not None:
                    self.gram[:, c] += (T * weight[:, None, part]) @ T.transpose(0, 2, 1)


def solve_weights(columns: Columns, sums: Sums, low: FloatArray) -> FloatArray:
    """Return the weights (points, channels, lobes) that minimise E² to second order.

    `sums`: the `Sums` at weights of 0; values that are factors of squared weights are ignored;
    `low` (lobes,): the smallest weights.
    """
    points, channels = sums.moment.shape[:2]
    lobes = int(columns.lobes.max()) + 1
    gram = sums.gram[:, :, :lobes, :lobes].reshape(-1, lobes, lobes)
    moment = sums.moment[:, :, :lobes].reshape(-1, lobes)
    return minimise_in_box(gram, moment, low, np.inf).reshape(points, channels, lobes)


def move_sums_to_weights(columns: Columns, sums: Sums, weights: FloatArray) -> Sums:
    """Return the `Sums` at `weights`, from `sums` at weights of 0, for a linear difference."""
    factors = weights[:, :, columns.lobes] ** columns.powers
    values = len(columns.lobes)
    by_values = sums.gram[:, :, :, :values] @ factors[..., None]
    moment = sums.moment + by_values[..., 0]
    both = (sums.moment + moment)[:, :, :values] * factors
    return Sums(np.maximum(sums.error + both.sum(axis=(1, 2)), 0), moment, sums.gram)
