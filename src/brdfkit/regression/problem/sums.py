"""Sums over samples, of which a fit is made, and the weights that follow from them."""

from dataclasses import dataclass

import numpy as np

from brdfkit.regression.problem.box_quadratic import minimise_in_box

# Columns are multiplied in parts of this many numbers, which stay in the processor's cache
PART = 2**16


@dataclass(eq=False)
class Sums:
    """Sums over samples at several points, with T the columns, d the loss's difference, d' its
    derivative by the model's value and w a sample's importance.

    `error` Σ w d² (points,); `moment` Σ w d d' T (points, channels, columns); `gram`
    Σ w d'² T Tᵀ (points, channels, columns, columns), or None.
    """

    error: np.ndarray
    moment: np.ndarray
    gram: np.ndarray | None

    @classmethod
    def zeros(cls, points, channels, columns, curvature=True):
        """No samples yet."""
        gram = np.zeros((points, channels, columns, columns)) if curvature else None
        return cls(np.zeros(points), np.zeros((points, channels, columns)), gram)

    def finite(self):
        """Whether they are finite."""
        return bool(np.isfinite(self.error).all() and np.isfinite(self.moment).all())

    @np.errstate(invalid="ignore")  # `finite` tells
    def add(self, columns, squares, moments, weights):
        """Add samples: `columns`, a list of T (points, n); `squares` Σ_c w d² (points, n);
        `moments` w d d' and `weights` w d'², lists by channel of (points, n)."""
        points, n = squares.shape
        self.error += squares.sum(axis=1)
        step = max(PART // (points * len(columns)), 64)
        for start in range(0, n, step):
            part = slice(start, start + step)
            T = np.stack([column[:, part] for column in columns], axis=1)
            for c, (moment, weight) in enumerate(zip(moments, weights, strict=True)):
                self.moment[:, c] += (T @ moment[:, part, None])[:, :, 0]
                if self.gram is not None:
                    self.gram[:, c] += (T * weight[:, None, part]) @ T.transpose(0, 2, 1)


def solve_weights(columns, sums, low):
    """The weights (points, channels, lobes) that minimise E² to second order, of `Sums` at weights
    of 0; without the values that are factors of squared weights. `low` (lobes,): least weights."""
    points, channels = sums.moment.shape[:2]
    lobes = int(columns.lobes.max()) + 1
    gram = sums.gram[:, :, :lobes, :lobes].reshape(-1, lobes, lobes)
    moment = sums.moment[:, :, :lobes].reshape(-1, lobes)
    return minimise_in_box(gram, moment, low, np.inf).reshape(points, channels, lobes)


def move_weights(columns, sums, weights):
    """The `Sums` at `weights`, of those at weights of 0, where the difference is linear."""
    factors = weights[:, :, columns.lobes] ** columns.powers
    values = len(columns.lobes)
    by_values = sums.gram[:, :, :, :values] @ factors[..., None]
    moment = sums.moment + by_values[..., 0]
    both = (sums.moment + moment)[:, :, :values] * factors
    return Sums(np.maximum(sums.error + both.sum(axis=(1, 2)), 0), moment, sums.gram)
