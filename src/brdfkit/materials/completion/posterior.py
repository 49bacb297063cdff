"""The posterior of a prior: the most probable material, given measured values, and its variance.

The measured logarithms y of a channel are the prior's model at the samples, plus noise of the
variance σ². With w = 1 / (ℓ + σ²), and W the diagonal matrix of w, the components' weights z are

    P = (I + QᵀWQ)⁻¹,    z = P QᵀW (y - μ),    Var y = diag(Q P Qᵀ) + ℓ.

Materials that are farther from the prior than its own have wider intervals, by one factor s:

    K = QQᵀ + W⁻¹,    s² = (ν₀ + Σ (y - μ)ᵀ K⁻¹ (y - μ)) / (ν₀ + n),

where the sum runs over the channels, and n counts all their values. Deviations are multiplied by s
where it is above 1, and intervals are those of a t distribution of ν₀ + n degrees of freedom.
"""

from dataclasses import dataclass

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray
from brdfkit.materials.completion.observations import Observations
from brdfkit.materials.completion.prior import Prior

EFFECTIVE_SAMPLES = 300  # more samples count as so many, because their misfits go together
INDEPENDENT_CHANNELS = 3  # more channels are not independent of each other
DEGREES_OF_FREEDOM = 4  # ν₀
ROUNDS = 3  # of a model of the measurement that depends on the material


@dataclass(frozen=True, eq=False)
class Posterior:
    """The logarithms of a material in all cells of a prior, and their deviations.

    `logarithm`, `deviation` (channels, CELLS): ln(f c + e), and its standard deviation. `scale`: s.
    `freedom`: degrees of freedom of the intervals.
    """

    logarithm: FloatArray
    deviation: FloatArray
    scale: float
    freedom: float


def solve(prior: Prior, observed: Observations) -> Posterior:
    """Return the `Posterior` of a material's `Observations`."""
    count = min(1.0, EFFECTIVE_SAMPLES / len(observed))
    logarithms, deviations, misfits = [], [], []
    # With many samples the mean follows them closely, as it could materials of the prior; the
    # intervals are always those of other materials
    remainder = prior.new_remainder if count == 1 else prior.remainder
    for k in range(observed.logarithm.shape[1]):
        channel = ChannelSolver(prior, observed, k, count)
        z = channel.find_weights(remainder)
        covariance, misfit = channel.find_covariance()
        root = np.linalg.cholesky(covariance)
        variance = np.sum((prior.components @ root) ** 2, axis=1) + prior.new_remainder
        logarithms.append(prior.mean + prior.components @ z)
        deviations.append(np.sqrt(variance))
        misfits.append(misfit)
    values = min(len(misfits), INDEPENDENT_CHANNELS) * len(observed) * count
    total = float(np.mean(misfits)) * min(len(misfits), INDEPENDENT_CHANNELS)
    freedom = DEGREES_OF_FREEDOM + values
    scale = float(np.sqrt((DEGREES_OF_FREEDOM + total) / freedom))
    return Posterior(np.array(logarithms), np.array(deviations) * max(scale, 1.0), scale, freedom)


class ChannelSolver:
    """Finds the weights of the components for one channel.

    `count` is the share of a sample by which each counts.
    """

    def __init__(self, prior: Prior, observed: Observations, channel: int, count: float) -> None:
        self.prior, self.observed, self.count = prior, observed, count
        self.logarithm = observed.logarithm[:, channel]
        self.noise = observed.variance[:, channel]
        self.designs = [part.interpolate(prior.components) for part in observed.cone]
        self.means = [part.interpolate(prior.mean) for part in observed.cone]
        self.design, self.residual = self.designs[0], self.logarithm - self.means[0]
        self.extra: FloatArray = np.zeros(len(observed))

    def find_weights(self, remainder: AnyArray) -> FloatArray:
        """Return the most probable weights z (rank,), for remainders ℓ (CELLS,)."""
        left = self.observed.lookup.interpolate(remainder)
        z: FloatArray = np.zeros(self.design.shape[1])
        for _ in range(ROUNDS if self.observed.depends_on_material else 1):
            self._linearise(z)
            _, z = self._invert((left + self.noise + self.extra) / self.count)
        return z

    def find_covariance(self) -> tuple[FloatArray, float]:
        """Return the covariance P of the weights, and the misfit (y - μ)ᵀ K⁻¹ (y - μ)."""
        left = self.observed.lookup.interpolate(self.prior.new_remainder)
        variance = (left + self.noise + self.extra) / self.count
        covariance, z = self._invert(variance)
        # (y - μ)ᵀ K⁻¹ (y - μ) by the matrix inversion lemma
        return covariance, float((self.residual / variance) @ (self.residual - self.design @ z))

    def _linearise(self, z: FloatArray) -> None:
        """Linearise the model of the measurement at the weights `z`."""
        if not self.observed.depends_on_material:
            return
        logarithm = self.prior.mean + self.prior.components @ z
        self.extra = self.observed.compute_turned_variance(logarithm)
        predicted, slopes = self.observed.predict(logarithm)
        self.design = np.sum(
            [slope[:, None] * part for slope, part in zip(slopes, self.designs, strict=True)],
            axis=0,
        )
        self.residual = self.logarithm - predicted + self.design @ z

    def _invert(self, variance: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the covariance P and the weights z, for variances (n,) of the samples."""
        weighted = self.design / variance[:, None]
        covariance = np.linalg.inv(np.eye(self.design.shape[1]) + self.design.T @ weighted)
        return covariance, covariance @ (weighted.T @ self.residual)
