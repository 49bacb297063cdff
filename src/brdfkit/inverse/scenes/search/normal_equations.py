"""The normal equations of Gauss and Newton by rendered pictures, without the bias of their noise.

A square of noisy differences is too large by the noise's variance, and its least value lies where
the noise is least. So two pictures I_A, I_B are rendered, of samples that are independent, beside a
picture J to reach:

    E² = Σ w (I_A - J)(I_B - J)
    g = ½ Σ w (∂I_A (I_B - J) + ∂I_B (I_A - J))
    H = ½ Σ w (∂I_A ∂I_Bᵀ + ∂I_B ∂I_Aᵀ)

are right in the mean, however few the samples; w goes with the picture to reach alone.

Where single samples hit a highlight, it is bright in one half and missing in the other, and E² far
below 0: of many points, the one with most luck has the least. So points are compared by a bound, E²
and twice its standard deviation

    ½ √Σ (w (I_A - J)² - w (I_B - J)²)²

whose square is right in the mean. For a highlight that was hit once it is more than E² is below 0.
"""

from dataclasses import dataclass

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.inverse.scenes.problem.leverage import sum_by_block, without_leverage
from brdfkit.inverse.scenes.search.forward_derivatives import DERIVATIVE_COST, derivatives, tangents

SHARE = 2.0  # of the cost of a step's pictures, what its derivatives may cost
ROUNDING = 1e-6  # of white, of pictures in single precision
QUIETEST = 0.1  # of the power of derivatives, what may be left of it without their noise
SURE = 2  # deviations, beyond which a difference is no chance
SMALLEST = 1e-5  # eigenvalue of H, of unit diagonal, below which there is noise


@dataclass(frozen=True)
class Residuals:
    """Two halves `a`, `b` (pixels, channels) of rendered less reached pixels, at coordinates `x`,
    by `spp` samples each; weighed, the `terms` of the pixels that count add up to E², which has the
    standard `deviation` by the noise of rendering."""

    x: np.ndarray
    a: np.ndarray
    b: np.ndarray
    spp: int
    terms: np.ndarray
    deviation: float

    @classmethod
    def at(cls, views, x, spp, seed):
        """Of the `Views` at `x`, by half of `spp` samples each."""
        half = max(1, spp // 2)
        a, b = views.residuals(x, half, seed), views.residuals(x, half, seed + 1000)
        terms, apart = ((views.weights * t).sum(axis=1) for t in (a * b, (a - b) * (a + b)))
        deviation = float(np.sqrt((apart[views.seen] ** 2).sum()) / 2)
        return cls(x, a, b, half, terms[views.seen], deviation)

    @property
    def error(self):
        """E², of the weights' mean; it may be below 0 where it is less than the noise. Infinite
        where a picture is not finite, as of light that multiplies from one bounce to the next."""
        total = self.terms.sum()
        return total if np.isfinite(total) else np.inf

    @property
    def bound(self):
        """What E² of more samples exceeds by chance alone."""
        return self.error + SURE * self.deviation if np.isfinite(self.error) else np.inf

    def less(self, other):
        """(how much less E² is in `other`, of the same samples; its standard error)."""
        if other.error == np.inf:
            return -np.inf, 0.0
        change = self.terms - other.terms
        return change.sum(), change.std() * np.sqrt(len(change))

    def noise(self, views):
        """What rendering adds to E² in a picture of both halves."""
        return float((views.weights * (self.a - self.b) ** 2).sum() / 4)


@dataclass(frozen=True)
class Equations:
    """E² to second order: `gradient` (n,), half of E²'s, `hessian` (n, n), and `scores`
    (n, blocks), what blocks of pixels add to the gradient, without their leverage; `power` (n,),
    the hessian's diagonal with the noise of the derivatives, which is never below 0."""

    gradient: np.ndarray
    hessian: np.ndarray
    scores: np.ndarray
    power: np.ndarray

    @classmethod
    def at(cls, views, here, seed, share=SHARE):
        """About `Residuals`; `share`: of their cost, what the derivatives may cost."""
        pictures = len(list(tangents(views)))
        spp = max(1, round(here.spp * min(1, share / (DERIVATIVE_COST * pictures))))
        a, b = (derivatives(views, here.x, spp, seed + 1000 * half) for half in (0, 1))
        _require_finite(views, a + b)
        weighed = views.weights * a
        hessian = weighed.reshape(len(a), -1) @ b.reshape(len(a), -1).T.astype(float)
        per_pixel = (weighed * here.b).sum(axis=2) + (views.weights * b * here.a).sum(axis=2)
        scores = sum_by_block(per_pixel / 2, views.blocks)
        lone = without_leverage(scores, (a + b) / 2 * np.sqrt(views.weights), views.blocks)
        power = ((weighed * a).sum(axis=(1, 2)) + (views.weights * b * b).sum(axis=(1, 2))) / 2
        return cls(scores.sum(axis=1), (hessian + hessian.T) / 2, lone, power)

    def unseen(self, views, x):
        """Whether (n,) the pictures about `x` change with a number by no more than rounding."""
        bounded = np.isfinite(views.most - views.least)
        extent = np.where(bounded, 1, np.maximum(abs(x), 1))
        return np.sqrt(self.power) * extent <= ROUNDING

    def gain(self, step):
        """How much less E² should be after a step (n,)."""
        return -float(2 * self.gradient @ step + step @ self.hessian @ step)

    def scaled(self):
        """(H, scale): H of unit diagonal, or less where derivatives are noise, its negative
        eigenvalues, of noise, too, lifted."""
        least = np.maximum(QUIETEST * self.power, 1e-30)
        scale = 1 / np.sqrt(np.maximum(np.diagonal(self.hessian), least))
        values, vectors = np.linalg.eigh(self.hessian * np.outer(scale, scale))
        lifted = np.maximum(values, SMALLEST)
        return (vectors * lifted) @ vectors.T, scale

    def surprise(self, free):
        """How far the gradient is from 0, in standard errors, a mean square over what is `free`."""
        g, scores = self.gradient[free], self.scores[free]
        centred = scores - scores.mean(axis=1, keepdims=True)
        scale = 1 / np.sqrt(np.maximum((centred**2).sum(axis=1), 1e-300))
        covariance = (centred * scale[:, None]) @ (centred * scale[:, None]).T
        g = g * scale
        return float(
            g @ np.linalg.pinv(covariance, rcond=1e-6, hermitian=True) @ g / max(1, len(g))
        )


def _require_finite(views, found):
    """Raise `BrdfkitError` for derivatives (n, pixels, channels) that are not finite."""
    bad = ~np.isfinite(found).all(axis=(1, 2))
    if bad.any():
        raise BrdfkitError(
            f"the pictures' derivatives by {views.names[int(np.argmax(bad))]} are not finite; "
            "begin elsewhere, or give it narrower bounds."
        )
