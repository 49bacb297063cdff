"""Computes the Gauss-Newton equations from rendered pictures, without bias from their noise.

The square of a noisy difference is too large by the variance of the noise, so its minimum would lie
where the noise is smallest. Therefore two pictures I_A and I_B with independent samples are
rendered and compared with the target picture J. With a weight w per pixel that depends on J alone,

    E² = Σ w (I_A - J)(I_B - J)
    g = ½ Σ w (∂I_A (I_B - J) + ∂I_B (I_A - J))          half of the gradient of E²
    H = ½ Σ w (∂I_A ∂I_Bᵀ + ∂I_B ∂I_Aᵀ)                  half of its Hessian

are unbiased for any number of samples.

If a single sample hits a highlight, the highlight is bright in one picture and missing in the
other, and E² is far below 0. Among many points, the luckiest one would then win. Points are
therefore compared by an upper bound, E² plus twice its standard deviation. The deviation is
estimated as

    ½ √Σ (w (I_A - J)² - w (I_B - J)²)²,

whose square is unbiased; for a highlight that was hit once, it exceeds the amount by which E² is
below 0.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from brdfkit.core.array_types import AnyArray, BoolArray, FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.inverse.scenes.problem.leverage import correct_for_leverage, sum_by_block
from brdfkit.inverse.scenes.problem.views import Views
from brdfkit.inverse.scenes.search.forward_derivatives import (
    DERIVATIVE_COST,
    compute_derivatives,
    count_derivative_pictures,
)

# largest cost of rendering all derivatives, as a multiple of that of the residuals
DERIVATIVE_SHARE = 2.0
ROUNDING = 1e-6  # rounding error of pixels in single precision, relative to white
# Diagonal entries of the Hessian are raised to this share of the squared derivatives at least,
# since smaller ones are noise
NOISE_FLOOR = 0.1
CONFIDENCE = 2  # differences of up to this number of standard deviations may be chance
# Eigenvalues of the Hessian, scaled to a unit diagonal, are raised to this at least, since smaller
# ones are noise
SMALLEST_EIGENVALUE = 1e-5


@dataclass(frozen=True)
class Residuals:
    """Rendered minus target pixels at coordinates `x`, in two pictures with independent samples.

    a, b : the residuals (pixels, channels) of the two pictures.
    spp : the samples per pixel of each picture.
    terms : the contributions of the pixels that count to the squared residual E².
    deviation : the standard deviation of E² due to the noise of rendering.
    """

    x: FloatArray
    a: FloatArray
    b: FloatArray
    spp: int
    terms: FloatArray
    deviation: float

    @classmethod
    def render(cls, views: Views, x: FloatArray, spp: int, seed: int) -> Residuals:
        """Render the residuals at `x`, with half of `spp` samples for each of the two pictures."""
        half = max(1, spp // 2)
        a, b = (views.render_residuals(x, half, seed + offset) for offset in (0, 1000))
        terms, apart = ((views.weights * t).sum(axis=1) for t in (a * b, (a - b) * (a + b)))
        deviation = float(np.sqrt((apart[views.counted] ** 2).sum()) / 2)
        return cls(x, a, b, half, terms[views.counted], deviation)

    @property
    def error(self) -> float:
        """The squared residual E², which noise may make negative.

        Infinite if a picture is not finite, as where each bounce of light makes it brighter.
        """
        total = float(self.terms.sum())
        return total if np.isfinite(total) else np.inf

    @property
    def bound(self) -> float:
        """The upper confidence bound of the squared residual, two standard deviations above it."""
        return self.error + CONFIDENCE * self.deviation if np.isfinite(self.error) else np.inf

    def compute_gain(self, other: Residuals) -> tuple[float, float]:
        """Return how much smaller the squared residual is in `other`, and its standard error.

        Both need the same number of samples.
        """
        if other.error == np.inf:
            return -np.inf, 0.0
        change = self.terms - other.terms
        return float(change.sum()), float(change.std() * np.sqrt(len(change)))

    def compute_noise(self, views: Views) -> float:
        """Return how much noise of rendering adds to the squared residual of the mean picture."""
        return float((views.weights * (self.a - self.b) ** 2).sum() / 4)


@dataclass(frozen=True)
class Equations:
    """The quadratic approximation of the squared residual E² around a point.

    gradient : half of the gradient (n,) with respect to the search coordinates.
    hessian : half of the Gauss-Newton Hessian (n, n).
    scores : the contributions (n, blocks) of blocks of pixels to the gradient, corrected for
        leverage.
    power : the diagonal (n,) of the Hessian including the noise of the derivatives, so never < 0.
    """

    gradient: FloatArray
    hessian: FloatArray
    scores: FloatArray
    power: FloatArray

    @classmethod
    def render(
        cls, views: Views, here: Residuals, seed: int, share: float = DERIVATIVE_SHARE
    ) -> Equations:
        """Render derivatives at the point of `here`, at no more than `share` of its cost."""
        pictures = count_derivative_pictures(views)
        spp = max(1, round(here.spp * min(1, share / max(DERIVATIVE_COST * pictures, 1e-9))))
        a, b = (compute_derivatives(views, here.x, spp, seed + 1000 * half) for half in (0, 1))
        _check_finite(views, a + b)
        weighed = views.weights * a
        hessian = weighed.reshape(len(a), -1) @ b.reshape(len(a), -1).T.astype(float)
        per_pixel = (weighed * here.b).sum(axis=2) + (views.weights * b * here.a).sum(axis=2)
        scores = sum_by_block(per_pixel / 2, views.blocks)
        jacobian = (a + b) / 2 * np.sqrt(views.weights)
        corrected = correct_for_leverage(scores, jacobian, views.blocks)
        power = ((weighed * a).sum(axis=(1, 2)) + (views.weights * b * b).sum(axis=(1, 2))) / 2
        return cls(scores.sum(axis=1), (hessian + hessian.T) / 2, corrected, power)

    def find_unseen_numbers(self, views: Views, x: FloatArray) -> BoolArray:
        """Return the mask (n,) of numbers on which the pictures around `x` do not depend.

        Changes below the rounding of pixels do not count.
        """
        is_bounded = np.isfinite(views.upper_bounds - views.lower_bounds)
        extent = np.where(is_bounded, 1, np.maximum(abs(x), 1))
        return np.sqrt(self.power) * extent <= ROUNDING

    def predict_gain(self, step: FloatArray) -> float:
        """Return by how much a step (n,) reduces the squared residual of the linearised problem."""
        return -float(2 * self.gradient @ step + step @ self.hessian @ step)

    def scale_hessian(self) -> tuple[FloatArray, FloatArray]:
        """Return the Hessian in units that make its diagonal 1, and the units (n,).

        The diagonal is less than 1 where the derivatives are mostly noise. Eigenvalues that noise
        made negative are raised to a small positive one.
        """
        least = np.maximum(NOISE_FLOOR * self.power, 1e-30)
        scale = 1 / np.sqrt(np.maximum(np.diagonal(self.hessian), least))
        values, vectors = np.linalg.eigh(self.hessian * np.outer(scale, scale))
        return (vectors * np.maximum(values, SMALLEST_EIGENVALUE)) @ vectors.T, scale

    def measure_gradient_significance(self, free: BoolArray) -> float:
        """Return the mean squared distance of the gradient from 0, in standard errors.

        Only the numbers in the mask `free` (n,) enter. The value is about 1 if only noise is left.
        """
        gradient, scores = self.gradient[free], self.scores[free]
        centred = scores - scores.mean(axis=1, keepdims=True)
        scale = 1 / np.sqrt(np.maximum((centred**2).sum(axis=1), 1e-300))
        covariance = (centred * scale[:, None]) @ (centred * scale[:, None]).T
        gradient = gradient * scale
        inverse = np.linalg.pinv(covariance, rcond=1e-6, hermitian=True)
        return float(gradient @ inverse @ gradient / max(1, len(gradient)))


def _check_finite(views: Views, derivatives: AnyArray) -> None:
    """Raise `BrdfkitError` for derivatives (n, pixels, channels) that are not finite."""
    bad = ~np.isfinite(derivatives).all(axis=(1, 2))
    if bad.any():
        raise BrdfkitError(
            f"the pictures' derivatives by {views.names[int(np.argmax(bad))]} are not finite; "
            "begin elsewhere, or give it narrower bounds."
        )
