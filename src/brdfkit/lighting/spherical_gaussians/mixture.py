"""`Mixture`: a weighted sum of von Mises-Fisher lobes, fitted by expectation maximisation.

    f(x) ≈ Σ_k α_k g(x; μ_k, κ_k),  Σ_k α_k = 1

Samples have weights, so that samples of a distribution and the values of a function at the points
of a quadrature are fitted alike. A sample may stand for the directions around it: its vector is
their mean then, shorter than 1. Such samples bound κ, since no lobe can close in on a point.

[Ergun 2015, eqs. 8.4 - 8.6]; the steps are those of [Banerjee et al. 2005], with the exact κ in
place of their approximation, by which the likelihood never falls.
"""

from dataclasses import dataclass

import numpy as np

from brdfkit.lighting.spherical_gaussians import von_mises_fisher as vmf

TINY = 1e-12  # the least weight of a lobe: its logarithm is finite


@dataclass(frozen=True)
class Mixture:
    """Lobes with `weights` (n,), whose sum is 1, `axes` (n, 3) and concentrations `kappa` (n,)."""

    weights: np.ndarray
    axes: np.ndarray
    kappa: np.ndarray

    def log_lobes(self, x):
        """log(α_k g_k(x)) (n, samples)."""
        # κ μ·x, and what is the same for all samples
        constant = np.log(self.weights) + vmf.log_density(0, self.kappa)
        return (self.kappa[:, None] * self.axes) @ x.T + constant[:, None]

    def shares(self, x):
        """γ (n, samples), each lobe's share of each sample, and log f (samples,) at the samples."""
        share = self.log_lobes(x)
        largest = share.max(axis=0)
        np.exp(np.subtract(share, largest, out=share), out=share)
        total = share.sum(axis=0)
        share /= total
        return share, np.log(total) + largest


def of_clusters(x, weights, cluster, n):
    """The mixture (n lobes) of samples that each belong to the `cluster` (samples,), a number."""
    return _maximisation(x, weights, np.eye(n)[:, cluster])


def fit(x, weights, start, steps=200, tolerance=1e-7):
    """The mixture of samples `x` (m, 3) with `weights` (m,), from the mixture `start`.

    Returns the mixture and the mean log likelihood before each step (steps,), which never falls.
    Stops after `steps`, or when a step gains less than `tolerance`.
    """
    found, likelihood = start, []
    for _ in range(steps):
        share, log_f = found.shares(x)
        likelihood.append(weights @ log_f / weights.sum())
        if len(likelihood) > 1 and likelihood[-1] - likelihood[-2] < tolerance:
            break
        found = _maximisation(x, weights, share, found)
    return found, np.array(likelihood)


def _maximisation(x, weights, share, before=None):
    """The likeliest mixture for these shares; a lobe without samples stays as it was `before`."""
    share = share * weights
    each = share.sum(axis=1)
    mean = share @ x / np.maximum(each, TINY * weights.sum())[:, None]
    length = np.linalg.norm(mean, axis=1)
    empty = length < TINY
    other = before.axes if before else np.array([0.0, 0.0, 1.0])
    axes = np.where(empty[:, None], other, mean / np.where(empty, 1, length)[:, None])
    return Mixture(np.maximum(each / weights.sum(), TINY), axes, vmf.kappa_of(length))
