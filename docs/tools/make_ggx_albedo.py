"""Fits the polynomials of `brdfkit.model.ggx_albedo` to quadratures, and prints their coefficients.

python docs/tools/make_ggx_albedo.py

The albedo E₁ of facets that reflect all light, and the mean of Schlick's (1 - V·H)⁵ over the light
that they reflect, are means over visible normals, which a grid of random numbers draws. The
polynomials have the least maximum error, by Lawson's weights.
"""

import itertools

import numpy as np

from brdfkit.core.geometry.vectors import cos_theta_d, dot
from brdfkit.core.jit import double_precision
from brdfkit.model.ggx_albedo import DEGREE
from brdfkit.model.microfacet import TrowbridgeReitz, fifth_power

GRID = 400  # random numbers along each axis
# Roughnesses √α, and cosines over α so that t = μ / (μ + α) is even, with further even cosines
ROUGHNESSES = np.linspace(0.04, 1, 45)
PLACES = (np.arange(60) + 0.5) / 60


def integrate(cosine, alpha):
    """Return E₁ and the mean of (1 - V·H)⁵ for one angle of incidence and one width."""
    import drjit as dr

    steps = (np.arange(GRID) + 0.5) / GRID
    x, y = (double_precision.to_array(a.ravel()) for a in np.meshgrid(steps, steps))
    u, zero = double_precision.Vector(x, y, 0 * x), 0 * x
    mu, alpha = double_precision.to_scalar(cosine), double_precision.to_scalar(alpha)
    slopes = TrowbridgeReitz(alpha, alpha)
    wi = double_precision.Vector(dr.sqrt(1 - mu * mu) + zero, zero, mu + zero)
    h = slopes.sample(wi, u)
    wo = h * (2 * dot(wi, h)) - wi
    above = double_precision.Vector(wo.x, wo.y, dr.maximum(wo.z, 1e-12))
    shadowing = dr.select(wo.z > 0, slopes.G2(wi, above) / slopes.G1(wi), 0)
    albedo, grazing = (
        float(dr.mean(values)[0])
        for values in (shadowing, shadowing * fifth_power(1 - cos_theta_d(wi, wo)))
    )
    return albedo, grazing / albedo


def fit(columns, values, sensitivity):
    """Return the coefficients with the least maximum error, times `sensitivity` (n,), and it."""
    columns, values = columns * sensitivity[:, None], values * sensitivity
    weights, best, least = np.ones(len(values)), None, np.inf
    for _ in range(300):
        root = np.sqrt(weights)
        found = np.linalg.lstsq(columns * root[:, None], values * root, rcond=1e-13)[0]
        errors = np.abs(columns @ found - values)
        if errors.max() < least:
            best, least = found, errors.max()
        weights = weights * (errors / errors.max() + 1e-3)
        weights /= weights.mean()
    return best, least


if __name__ == "__main__":
    place, q = (a.ravel() for a in np.meshgrid(PLACES, ROUGHNESSES))
    alpha = np.tile(q * q, 2)
    mu = np.concatenate([place * q * q / (1 - place), place**1.5])
    alpha, mu = alpha[mu <= 1], mu[mu <= 1]
    albedo, share = np.array(list(itertools.starmap(integrate, zip(mu, alpha, strict=True)))).T
    t, s, q = mu / (mu + alpha), np.sqrt(mu), np.sqrt(alpha)
    powers = [p for p in itertools.product(range(DEGREE + 1), repeat=3) if sum(p) <= DEGREE]
    columns = np.stack([t**i * s**j * q**k for i, j, k in powers], axis=1)
    edge = t * (1 - t)
    lost, error = fit(columns, (1 - albedo) / edge, edge)
    mean = share**0.2
    rise, other = fit(columns, mean, 5 * albedo * mean**4)
    print(f"LOST, to {error:.1e} of E₁:", ", ".join(f"{c:.6g}" for c in lost))
    print(f"RISE, to {other:.1e} of E₁ (1 - V·H)⁵:", ", ".join(f"{c:.6g}" for c in rise))
