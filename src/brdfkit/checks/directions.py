"""Checks that the samplers of directions over the whole sphere share: of light and of scattering.

A sampler is given as two functions: `draw(u, v)` → (direction, weight, density) of the unit square,
and `pdf(direction)`.
"""

import numpy as np

from brdfkit.padding import pad

SIGNIFICANCE = 0.01
SAMPLES = 400_000
CELLS, SUBCELLS = 101, 32  # of χ²'s histogram; fewer points in a cell reject a small sun
RINGS, POINTS = 512, 1024  # of the quadrature: polar angles, azimuths


def chi_squared(draw, pdf, tests):
    """Pearson's p that directions follow their density, and whether that is accepted."""
    import drjit as dr
    import mitsuba as mi
    from mitsuba.chi2 import ChiSquareTest, SphericalDomain

    def sample(u):
        direction, _, density = draw(u[0], u[1])
        return direction, dr.select(density > 0, mi.Float(1), 0)

    test = ChiSquareTest(SphericalDomain(), sample, pdf, 2, SAMPLES, res=CELLS, ires=SUBCELLS)
    return test.p_value if test.run(SIGNIFICANCE, test_count=tests, quiet=True) else None


def square(n, seed):
    """Points of the unit square, (u, v), each a `mi.Float` of `n` numbers."""
    import mitsuba as mi

    u = np.random.default_rng(seed).random((2, n), np.float32)
    return tuple(mi.Float(pad(row)) for row in u)


def sphere():
    """Directions over the whole sphere and their solid angles, for sums: (mi.Vector3f, (n,))."""
    import mitsuba as mi

    theta = (np.arange(RINGS) + 0.5) / RINGS * np.pi
    phi = (np.arange(POINTS) + 0.5) / POINTS * 2 * np.pi
    theta, phi = (a.ravel() for a in np.meshgrid(theta, phi, indexing="ij"))
    w = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)])
    return mi.Vector3f(w.astype(np.float32)), np.sin(theta) * 2 * np.pi**2 / (RINGS * POINTS)


def numbers(value, n):
    """A number per direction (n,), of a constant, too."""
    return np.broadcast_to(np.array(value, float).ravel(), n)


def agreement(weights, expected):
    """By how many standard errors the mean of `weights` (channels, n) is off `expected`."""
    weights = np.asarray(weights, float)
    error = np.hypot(weights.std(axis=1) / np.sqrt(weights.shape[1]), 1e-3 * np.abs(expected))
    return float(np.max(np.abs(weights.mean(axis=1) - expected) / np.maximum(error, 1e-12)))
