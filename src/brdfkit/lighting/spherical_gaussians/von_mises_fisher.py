"""The von Mises-Fisher distribution, a spherical Gaussian with unit integral: a lobe about an axis.

    g(x; μ, κ) = κ / (2π (1 - e^(-2κ))) · e^(κ (μ·x - 1))

with the unit axis μ and the concentration κ ≥ 0: κ = 0 is the uniform density, a large κ is a lobe
of about 1/√κ radians. The formulas are stable for every κ; samples need κ > 0. Axes (..., 3) and
concentrations (...) broadcast.

[Ergun 2015, eqs. 8.1 - 8.9]; [Banerjee et al. 2005]
"""

from __future__ import annotations

import numpy as np

from brdfkit.core.array_types import AnyArray, ArrayLike, FloatArray

LARGEST_KAPPA = 1e8  # κ of a lobe as narrow as a ten-thousandth of a radian


def density(x: FloatArray, mu: ArrayLike, kappa: ArrayLike) -> AnyArray:
    """Return the von Mises-Fisher density g(x; μ, κ) (...) [sr⁻¹] at directions `x` (..., 3).

    >>> density(np.array([0, 0, 1.0]), np.array([0, 0, 1.0]), 0.0) * 4 * np.pi
    np.float64(1.0)
    """
    return np.exp(log_density(np.sum(np.asarray(mu) * x, axis=-1), kappa))


def log_density(cosine: ArrayLike, kappa: ArrayLike) -> AnyArray:
    """Return a lobe's log density (...) where the angle to its axis has this `cosine`."""
    cosine, kappa = np.asarray(cosine, float), np.asarray(kappa, float)
    return kappa * (cosine - 1) - np.log(4 * np.pi * _divide_expm1(-2 * kappa))


def _divide_expm1(x: AnyArray) -> AnyArray:
    """Return (e^x - 1) / x, and 1 where x is 0."""
    is_zero = x == 0
    return np.where(is_zero, 1.0, np.expm1(x) / np.where(is_zero, 1.0, x))


def mean_cosine(kappa: ArrayLike) -> FloatArray:
    """Return a lobe's mean cosine of the angle to its axis, coth κ - 1/κ (...).

    It is the length of the mean of directions that are distributed as the lobe.
    """
    kappa = np.asarray(kappa, float)
    large = np.maximum(kappa, 0.01)  # below 0.01 coth κ and 1/κ cancel, and a series is used
    return np.where(kappa < 0.01, kappa / 3 * (1 - kappa**2 / 15), 1 / np.tanh(large) - 1 / large)


def approximate_kappa(mean_cosine: AnyArray) -> AnyArray:
    """Return a lobe's concentration from its mean cosine, within 4 % [Banerjee et al. 2005].

    >>> round(approximate_kappa(0.9), 3)
    10.374
    """
    return (3 * mean_cosine - mean_cosine**3) / (1 - mean_cosine**2)


def solve_kappa(mean_length: ArrayLike) -> AnyArray:
    """Return a lobe's concentration κ (...) ≤ 1e8 from the length R̄ of its mean vector, 0 to 1.

    Newton's method solves coth κ - 1/κ = R̄.

    >>> float(solve_kappa(0.9).round(3))
    10.0
    """
    r = np.clip(np.asarray(mean_length, float), 0, 1 - 1 / LARGEST_KAPPA)
    kappa = approximate_kappa(r)
    for _ in range(4):  # each step doubles the number of correct digits
        # The slope hardly changes below κ = 0.01, where its terms cancel; sinh overflows beyond 300
        slope = 1 / np.maximum(kappa, 0.01) ** 2 - 1 / np.sinh(np.clip(kappa, 0.01, 300)) ** 2
        kappa = np.maximum(kappa + (r - mean_cosine(kappa)) / slope, 0)
    return np.minimum(kappa, LARGEST_KAPPA)


def sample_directions(mu: FloatArray, kappa: ArrayLike, u: ArrayLike) -> FloatArray:
    """Draw directions (..., 3) from lobes, by uniform random numbers `u` (..., 2) in [0, 1)."""
    # Inverts the distribution of cosθ; the argument of log1p is above -1, since u < 1
    u, kappa = np.asarray(u, float), np.asarray(kappa, float)
    cosine = 1 + np.log1p((1 - u[..., 0]) * np.expm1(-2 * kappa)) / kappa
    sine = np.sqrt(np.maximum(1 - cosine**2, 0))
    phi = 2 * np.pi * u[..., 1]
    x, y = tangents(mu)
    along = [part[..., None] for part in (sine * np.cos(phi), sine * np.sin(phi), cosine)]
    return along[0] * x + along[1] * y + along[2] * mu


def spread_lobe_points(mu: ArrayLike, kappa: ArrayLike, n: int) -> FloatArray:
    """Return `n` directions (..., n, 3) that are evenly spread by the probability of the lobe.

    They lie in the middles of n rings of equal probability, a golden section of a turn apart.
    """
    m = np.arange(n)
    u = np.stack([(m + 0.5) / n, np.mod(m * (np.sqrt(5) - 1) / 2, 1)], axis=-1)
    return sample_directions(np.asarray(mu)[..., None, :], np.asarray(kappa, float)[..., None], u)


def tangents(mu: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Return two unit vectors (..., 3) that form a right-handed orthonormal frame with μ (..., 3).

    They are the x and y axes after the smallest rotation of z (or -z, for μ below the horizon) to
    μ, so that they change smoothly within each hemisphere.
    """
    x, y, z = np.moveaxis(np.asarray(mu, float), -1, 0)
    sign = np.where(z < 0, -1.0, 1.0)
    a = 1 / (1 + np.abs(z))
    return (
        np.stack([1 - x * x * a, -x * y * a, -sign * x], axis=-1),
        np.stack([-sign * x * y * a, sign * (1 - y * y * a), -y], axis=-1),
    )
