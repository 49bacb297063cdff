"""The thesis's law of one parameter: sorted blocks have probabilities as 1 / (u + x).

[Ergun 2015, eqs. 6.3-6.5]. Sorted shares are seldom so, and where they are not, samples are noisier
than by the exact shares.
"""

from dataclasses import dataclass
from types import ModuleType

import numpy as np


@dataclass(frozen=True)
class Hyperbolic:
    """The law of `n` blocks with the parameter `u` > 0; see the package."""

    n: int
    u: float
    maths: ModuleType = np

    @classmethod
    def fit(cls, shares):
        """The law of maximum likelihood: the largest Σ P log P̂ over log u.

        >>> Hyperbolic.fit(Hyperbolic(256, 5.0).probability(np.arange(256))).u    # doctest: +SKIP
        5.000
        """
        from scipy.optimize import minimize_scalar

        n = len(shares)
        i = np.arange(n)

        def loss(log_u):
            return -shares @ np.log(cls(n, np.exp(log_u)).probability(i))

        # From nearly all light in one block, to even shares
        found = minimize_scalar(loss, bounds=(-10, np.log(n) + 10), method="bounded")
        return cls(n, float(np.exp(found.x)))

    def cumulative(self, x):
        """F(x), eq. 6.4."""
        log = self.maths.log
        return log(1 + x / self.u) / log(1 + self.n / self.u)

    def probability(self, i):
        """P̂(i) = F(i + 1) - F(i), eq. 6.4."""
        log = self.maths.log
        return log(1 + 1 / (self.u + i)) / log(1 + self.n / self.u)

    def inverse(self, xi):
        """F⁻¹(ξ), eq. 6.5."""
        return self.u * ((1 + self.n / self.u) ** xi - 1)
