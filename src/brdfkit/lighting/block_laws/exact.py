"""Blocks chosen by their exact shares of the power, by a table that is searched."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Exact:
    """The law that is the `shares` (n,) themselves; see the package."""

    shares: np.ndarray

    @classmethod
    def fit(cls, shares):
        """The law itself."""
        return cls(shares)

    def cumulative(self, x):
        """F(x)."""
        return np.interp(x, np.arange(len(self.shares) + 1), self._below)

    def probability(self, i):
        """P̂(i), the share."""
        return self.shares[i]

    def inverse(self, xi):
        """F⁻¹(ξ)."""
        i = np.searchsorted(self._below[1:-1], xi, side="right")
        return i + (xi - self._below[i]) / np.maximum(self.shares[i], 1e-300)

    @property
    def _below(self):
        return np.append(0, np.cumsum(self.shares))

    def in_renderer(self):
        """What chooses blocks in Mitsuba's current variant."""
        return _Table(self.shares)


class _Table:
    def __init__(self, shares):
        import mitsuba as mi

        self.table = mi.DiscreteDistribution(shares.tolist())
        self.nbytes = 8 * len(shares)  # shares and their sums, in single precision

    def choose(self, u, active):
        return self.table.sample_reuse_pmf(u, active)
