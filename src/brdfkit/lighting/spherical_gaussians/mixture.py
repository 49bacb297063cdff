"""`Mixture`: a weighted sum of von Mises-Fisher lobes, fitted by expectation maximisation.

    f(x) ≈ Σ_k α_k g(x; μ_k, κ_k),  Σ_k α_k = 1

Samples have weights, so that drawn samples and the points of a quadrature are fitted alike. A
sample may represent the directions around it. Its vector is then their mean, which is shorter than
1, and bounds κ, since no lobe can close in on a point.

[Ergun 2015, eqs. 8.4 - 8.6]; the steps are those of [Banerjee et al. 2005], but with the exact κ in
place of their approximation, so that the likelihood never falls.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from brdfkit.core.array_types import FloatArray, IntArray
from brdfkit.lighting.spherical_gaussians import von_mises_fisher as vmf

SMALLEST_WEIGHT = 1e-12  # of a lobe, so that its logarithm is finite


@dataclass(frozen=True)
class Mixture:
    """Lobes with `weights` (n,), whose sum is 1, `axes` (n, 3) and concentrations `kappa` (n,)."""

    weights: FloatArray
    axes: FloatArray
    kappa: FloatArray

    def log_lobes(self, x: FloatArray) -> FloatArray:
        """Return log(α_k g_k(x)) (n, samples) at directions `x` (samples, 3)."""
        # κ μ·x, plus what is the same for all samples
        constant = np.log(self.weights) + vmf.log_density(0, self.kappa)
        return (self.kappa[:, None] * self.axes) @ x.T + constant[:, None]

    def shares(self, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return each lobe's share γ (n, samples) of each sample, and log f (samples,)."""
        share = self.log_lobes(x)
        largest = share.max(axis=0)
        np.exp(np.subtract(share, largest, out=share), out=share)
        total = share.sum(axis=0)
        share /= total
        return share, np.log(total) + largest


def from_clusters(x: FloatArray, weights: FloatArray, cluster: IntArray, n: int) -> Mixture:
    """Return the mixture of `n` lobes that fits samples, given the `cluster` (samples,) of each."""
    return _maximise(x, weights, np.eye(n)[:, cluster])


def fit(
    x: FloatArray, weights: FloatArray, start: Mixture, steps: int = 200, tolerance: float = 1e-7
) -> tuple[Mixture, FloatArray]:
    """Fit a mixture to samples `x` (m, 3) with `weights` (m,), from the mixture `start`.

    Returns the mixture, and the mean log likelihood before each step, which never falls. Stops
    after `steps`, or when a step gains less than `tolerance`.
    """
    mixture, likelihood = start, []
    for _ in range(steps):
        share, log_f = mixture.shares(x)
        likelihood.append(weights @ log_f / weights.sum())
        if len(likelihood) > 1 and likelihood[-1] - likelihood[-2] < tolerance:
            break
        mixture = _maximise(x, weights, share, mixture)
    return mixture, np.array(likelihood)


def _maximise(
    x: FloatArray, weights: FloatArray, share: FloatArray, before: Mixture | None = None
) -> Mixture:
    """Return the likeliest mixture for each lobe's `share` (n, m) of the samples.

    The axis of a lobe without samples stays as it was `before`.
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
