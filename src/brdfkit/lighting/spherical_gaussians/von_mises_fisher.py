"""The von Mises-Fisher density, the spherical Gaussian of unit integral: one lobe about an axis.

    g(x; μ, κ) = κ / (2π (1 - e^(-2κ))) · e^(κ (μ·x - 1))

with the axis μ and the concentration κ ≥ 0: 0 is uniform, a large κ a lobe of about 1/√κ radians.
Stable for every κ; caps and samples want κ > 0. Axes (..., 3) and concentrations (...) broadcast.

[Ergun 2015, eqs. 8.1 - 8.9]; [Banerjee et al. 2005]
"""

import numpy as np
from scipy.special import exprel

MOST = 1e8  # the largest κ, of a lobe of a ten thousandth of a radian


def density(x, mu, kappa):
    """g(x; μ, κ) [sr⁻¹] at directions `x` (..., 3).

    >>> density(np.array([0, 0, 1.0]), np.array([0, 0, 1.0]), 0.0) * 4 * np.pi
    1.0
    """
    return np.exp(log_density(np.sum(np.asarray(mu) * x, axis=-1), kappa))


def log_density(cosine, kappa):
    """log g at the `cosine` μ·x of the angle to the axis."""
    return kappa * (cosine - 1) - np.log(4 * np.pi * exprel(-2 * np.asarray(kappa, float)))


def mean_cosine(kappa):
    """R̄ = coth κ - 1/κ: the length of the mean of directions distributed as g."""
    kappa = np.asarray(kappa, float)
    large = np.maximum(kappa, 0.01)  # below, the two terms cancel
    return np.where(kappa < 0.01, kappa / 3 * (1 - kappa**2 / 15), 1 / np.tanh(large) - 1 / large)


def kappa_near(mean_cosine):
    """κ ≈ (3R̄ - R̄³) / (1 - R̄²), within 4 % of the exact one [Banerjee et al. 2005].

    >>> round(kappa_near(0.9), 3)
    10.374
    """
    return (3 * mean_cosine - mean_cosine**3) / (1 - mean_cosine**2)


def kappa_of(mean_resultant):
    """The κ of R̄ in [0, 1], at most 1e8: solves coth κ - 1/κ = R̄ by Newton's steps.

    >>> float(kappa_of(0.9).round(3))
    10.0
    """
    r = np.clip(mean_resultant, 0, 1 - 1 / MOST)
    kappa = kappa_near(r)
    for _ in range(4):  # from within 4 %, each step doubles the digits
        # dR̄/dκ, which hardly changes below 0.01, where the two terms cancel; e^(2·300) is enough
        slope = 1 / np.maximum(kappa, 0.01) ** 2 - 1 / np.sinh(np.clip(kappa, 0.01, 300)) ** 2
        kappa = np.maximum(kappa + (r - mean_cosine(kappa)) / slope, 0)
    return np.minimum(kappa, MOST)


def cap_solid_angle(share, kappa):
    """Solid angle [sr] of the cap about the axis that holds a `share` in [0, 1) of the lobe.

    Exact, where eqs. 8.8 and 8.9 leave out e^(-2κ): Ω = -2π log(1 - a (1 - e^(-2κ))) / κ.
    """
    return -2 * np.pi / kappa * np.log1p(share * np.expm1(-2 * np.asarray(kappa, float)))


def cap_angle(share, kappa):
    """The angle [rad] from the axis to the edge of that cap."""
    return 2 * np.arcsin(np.sqrt(cap_solid_angle(share, kappa) / (4 * np.pi)))


def sample(mu, kappa, u):
    """Directions (..., 3), distributed as g, from uniform numbers `u` (..., 2) in [0, 1)."""
    # F⁻¹ of 1 - cos θ; log1p of a number above -1, since u < 1
    u = np.asarray(u, float)
    cosine = 1 + np.log1p((1 - u[..., 0]) * np.expm1(-2 * np.asarray(kappa, float))) / kappa
    sine = np.sqrt(np.maximum(1 - cosine**2, 0))
    phi = 2 * np.pi * u[..., 1]
    x, y = tangents(mu)
    along = [part[..., None] for part in (sine * np.cos(phi), sine * np.sin(phi), cosine)]
    return along[0] * x + along[1] * y + along[2] * mu


def points(mu, kappa, n):
    """`n` directions (..., n, 3) that stand for the lobe, each for 1/n of it.

    The middles of n rings of equal share, at azimuths a golden section of a turn apart.
    """
    m = np.arange(n)
    u = np.stack([(m + 0.5) / n, np.mod(m * (np.sqrt(5) - 1) / 2, 1)], axis=-1)
    return sample(np.asarray(mu)[..., None, :], np.asarray(kappa, float)[..., None], u)


def tangents(mu):
    """Two unit vectors (..., 3) that with μ (..., 3) make a right-handed frame.

    x and y of a frame whose z is turned to μ by the least turn, or -z for μ below the horizon, so
    that the tangents change smoothly with μ within each hemisphere.
    """
    x, y, z = np.moveaxis(np.asarray(mu, float), -1, 0)
    sign = np.where(z < 0, -1.0, 1.0)
    a = 1 / (1 + np.abs(z))
    return (
        np.stack([1 - x * x * a, -x * y * a, -sign * x], axis=-1),
        np.stack([-sign * x * y * a, sign * (1 - y * y * a), -y], axis=-1),
    )
