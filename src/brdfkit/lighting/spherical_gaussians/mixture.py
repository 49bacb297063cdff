"""`Mixture`: a weighted sum of von Mises-Fisher lobes, fitted by expectation maximisation.

    f(x) ≈ Σ_k α_k g(x; μ_k, κ_k),  Σ_k α_k = 1

Lobe k has the weight α_k, axis μ_k and concentration κ_k. Samples x have weights, so that they may
be drawn at random or be the points of a quadrature. A sample may represent the directions around
it: its vector is then their mean, which is shorter than 1, so that κ cannot become infinite.

[Ergun 2015, eqs. 8.4 - 8.6]; the steps are those of [Banerjee et al. 2005], but with the exact κ in
place of their approximation, so that the likelihood never falls.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from brdfkit.core.array_types import FloatArray, IntArray
from brdfkit.lighting.spherical_gaussians import von_mises_fisher as vmf

SMALLEST_WEIGHT = 1e-12  # lower limit of a lobe's weight, whose logarithm has to be finite


@dataclass(frozen=True)
class Mixture:
    """A mixture of von Mises-Fisher lobes, a probability density over directions.

    They have `weights` (n,), whose sum is 1, `axes` (n, 3) and concentrations `kappa` (n,).
    """

    weights: FloatArray
    axes: FloatArray
    kappa: FloatArray

    def log_lobe_densities(self, x: FloatArray) -> FloatArray:
        """Return the log densities of the weighted lobes, log(α_k g_k(x)) (n, samples), at `x`."""
        # A lobe's log density is κ μ·x, plus a constant that does not depend on the sample x
        constant = np.log(self.weights) + vmf.log_density(0, self.kappa)
        return (self.kappa[:, None] * self.axes) @ x.T + constant[:, None]

    def lobe_shares(self, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return each lobe's share of each sample (n, samples), and the log density (samples,).

        A lobe's share is its part of the mixture's density at the sample.
        """
        share = self.log_lobe_densities(x)
        largest = share.max(axis=0)
        np.exp(np.subtract(share, largest, out=share), out=share)
        total = share.sum(axis=0)
        share /= total
        return share, np.log(total) + largest


def make_mixture_from_clusters(
    x: FloatArray, weights: FloatArray, cluster: IntArray, n: int
) -> Mixture:
    """Return the mixture of `n` lobes that are fitted to clusters of the samples `x` (m, 3).

    `cluster` (m,) is the number of the cluster of each sample, from 0 to n - 1.
    """
    return _maximise_likelihood(x, weights, np.eye(n)[:, cluster])


def fit_mixture(
    x: FloatArray, weights: FloatArray, start: Mixture, steps: int = 200, tolerance: float = 1e-7
) -> tuple[Mixture, FloatArray]:
    """Fit a mixture to samples `x` (m, 3) with `weights` (m,) by expectation maximisation.

    The fit begins with the mixture `start`, and ends after `steps`, or when a step increases the
    mean log likelihood by less than `tolerance`. Returns the mixture, and the mean log likelihood
    before each step.
    """
    mixture, likelihood = start, []
    for _ in range(steps):
        share, log_f = mixture.lobe_shares(x)
        likelihood.append(weights @ log_f / weights.sum())
        if len(likelihood) > 1 and likelihood[-1] - likelihood[-2] < tolerance:
            break
        mixture = _maximise_likelihood(x, weights, share, mixture)
    return mixture, np.array(likelihood)


def _maximise_likelihood(
    x: FloatArray, weights: FloatArray, share: FloatArray, before: Mixture | None = None
) -> Mixture:
    """Return the mixture of maximum likelihood, given each lobe's `share` (n, m) of the samples.

    A lobe without samples keeps its axis from the mixture `before`.
    """
    share = share * weights
    each = share.sum(axis=1)
    mean = share @ x / np.maximum(each, SMALLEST_WEIGHT * weights.sum())[:, None]
    length = np.linalg.norm(mean, axis=1)
    empty = length < SMALLEST_WEIGHT
    other = before.axes if before else np.array([0.0, 0.0, 1.0])
    axes = np.where(empty[:, None], other, mean / np.where(empty, 1, length)[:, None])
    new_weights = np.maximum(each / weights.sum(), SMALLEST_WEIGHT)
    return Mixture(new_weights, axes, vmf.solve_kappa(length))
