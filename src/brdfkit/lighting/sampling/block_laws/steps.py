"""A law of eight steps: sorted blocks have equal probabilities within each of a few ranges.

F is linear in each range, and so is its inverse: sixteen numbers for any number of blocks. Shares
fall over decades; ranges that follow them leave little of the noise that the hyperbola adds.
"""

from dataclasses import dataclass
from types import ModuleType

import numpy as np

STEPS = 8
EDGES = 64  # places where a step may begin, in equal ratios of ranks


@dataclass(frozen=True)
class Steps:
    """The law of `n` blocks; step k has the blocks from `edges[k]` on and the `shares[k]`."""

    n: int
    edges: tuple
    shares: tuple
    maths: ModuleType = np

    @classmethod
    def fit(cls, shares):
        """The law of maximum likelihood, Σ P log P̂, by dynamic programming over the edges."""
        n = len(shares)
        edges = np.unique(np.append(0, np.geomspace(1, n, EDGES).round())).astype(int)
        below = np.append(0, np.cumsum(shares))[edges]
        share, width = below[None, :] - below[:, None], edges[None, :] - edges[:, None]
        likelihood = np.full(share.shape, -np.inf)  # of a step from one edge to another
        upwards = np.triu(np.ones(share.shape, bool), 1)
        black = upwards & (share <= 0)
        lit = upwards & ~black
        likelihood[black], likelihood[lit] = 0, share[lit] * np.log(share[lit] / width[lit])

        # The best k steps to every edge are the best k - 1 to some edge, and one more
        best, origins = likelihood[0], []
        for _ in range(min(STEPS, len(edges) - 1) - 1):
            sums = best[:, None] + likelihood
            origins.append(sums.argmax(axis=0))
            best = sums.max(axis=0)
        at = [len(edges) - 1]
        for origin in reversed(origins):
            at.insert(0, origin[at[0]])
        share = np.diff(below[at], prepend=0)
        return cls(n, tuple(np.append(0, edges[at[:-1]]).tolist()), tuple(share.tolist()))

    def _steps(self):
        """(First block, number of blocks, share of the steps below, share) of each step."""
        below = 0
        for first, end, share in zip(
            self.edges, (*self.edges[1:], self.n), self.shares, strict=True
        ):
            yield first, end - first, below, share
            below = below + share

    def cumulative(self, x):
        """F(x)."""
        clip = self.maths.clip
        return sum(share * clip((x - first) / n, 0, 1) for first, n, _, share in self._steps())

    def probability(self, i):
        """P̂(i)."""
        clip = self.maths.clip  # of whole numbers: 1 in the step, 0 outside it
        return sum(
            share / n * clip(i + 1 - first, 0, 1) * clip(first + n - i, 0, 1)
            for first, n, _, share in self._steps()
        )

    def inverse(self, xi):
        """F⁻¹(ξ)."""
        clip, maximum = self.maths.clip, self.maths.maximum
        return sum(
            n * clip((xi - below) / maximum(share, 1e-30), 0, 1)
            for _, n, below, share in self._steps()
        )
