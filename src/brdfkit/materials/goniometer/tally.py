"""The samples of the goniometer, summed up for each pair of directions."""

import numpy as np


class Tally:
    """Samples of m pairs of directions: their number (m,), sum and sum of squares (m, 3)."""

    def __init__(self, pairs):
        self.n = np.zeros(pairs, int)
        self.sums, self.squares = np.zeros((2, pairs, 3))

    def add(self, pair, samples):
        """Add `samples` (n, 3); `pair` (n,): the index of each sample's pair, ascending."""
        first = np.flatnonzero(np.diff(pair, prepend=-1))
        rows = pair[first]
        self.n[rows] += np.diff(first, append=len(pair))
        self.sums[rows] += np.add.reduceat(samples, first)
        self.squares[rows] += np.add.reduceat(samples**2, first)

    @property
    def mean(self):
        """The mean of the samples, (m, 3)."""
        return self.sums / self.n[:, None]

    @property
    def standard_error(self):
        """The standard error of the mean, (m, 3)."""
        n = self.n[:, None]
        variance = np.maximum(self.squares / n - self.mean**2, 0) * n / (n - 1)
        return np.sqrt(variance / n)

    @property
    def relative_error(self):
        """The relative error of the sum of the channels, (m,); infinite where the sum is 0."""
        errors, means = self.standard_error.sum(axis=1), self.mean.sum(axis=1)
        return np.divide(errors, means, out=np.full(len(means), np.inf), where=means > 0)
