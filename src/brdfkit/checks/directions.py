"""What the checks of emitters and of phase functions share: tests of samplers over the sphere.

A sampler is given as two functions: `draw(u, v)`, of a point of the unit square, or of the unit
cube, returns (direction, weight, density), and `pdf(direction)` the density.
"""

from functools import cache

import numpy as np

from brdfkit.core.jit.padding import pad

SIGNIFICANCE = 0.01
SAMPLES = 400_000
# Cells of the χ² test's histogram, and points to integrate the density in a cell, both along each
# axis; with fewer points the correct sampler of a small sun is rejected
CELLS, SUBCELLS = 101, 32
RINGS, POINTS = 512, 1024  # polar angles and azimuths of the quadrature


def chi_squared(draw, pdf, tests, dimensions=2):
    """The p-value of Pearson's χ² test that directions follow their density; None if it rejects.

    `tests`: how many such tests a check runs, which share the significance level; `dimensions`: how
    many random numbers `draw` takes.
    """
    import drjit as dr
    import mitsuba as mi
    from mitsuba.chi2 import ChiSquareTest, SphericalDomain

    def sample(u):
        direction, _, density = draw(*(u[i] for i in range(dimensions)))
        return direction, dr.select(density > 0, mi.Float(1), 0)

    test = ChiSquareTest(
        SphericalDomain(), sample, pdf, dimensions, SAMPLES, res=CELLS, ires=SUBCELLS
    )
    return test.p_value if test.run(SIGNIFICANCE, test_count=tests, quiet=True) else None


def random_points(n, seed, dimensions=2):
    """`n` random points of the unit square, or cube, as one `mi.Float` for each axis."""
    import mitsuba as mi

    u = np.random.default_rng(seed).random((dimensions, n), np.float32)
    return tuple(mi.Float(pad(row)) for row in u)


def quadrature():
    """Directions over the whole sphere, a `mi.Vector3f`, and their solid angles (n,)."""
    import mitsuba as mi

    w, solid_angle = _even_grid()
    return mi.Vector3f(w), solid_angle


@cache
def _even_grid():
    """The directions (3, n) of `quadrature`, and their solid angles."""
    theta = (np.arange(RINGS) + 0.5) / RINGS * np.pi
    phi = (np.arange(POINTS) + 0.5) / POINTS * 2 * np.pi
    theta, phi = (a.ravel() for a in np.meshgrid(theta, phi, indexing="ij"))
    w = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)])
    return w.astype(np.float32), np.sin(theta) * 2 * np.pi**2 / (RINGS * POINTS)


def numbers(value, n):
    """`value` as an array (n,): a number per direction, also where Mitsuba returned a constant."""
    return np.broadcast_to(np.array(value, float).ravel(), n)


def deviation(weights, expected):
    """How many standard errors the mean of `weights` (channels, n) is off `expected` (channels,).

    The largest over the channels.
    """
    weights = np.asarray(weights, float)
    # of the mean, and of the quadrature that gave `expected`
    error = np.hypot(weights.std(axis=1) / np.sqrt(weights.shape[1]), 1e-3 * np.abs(expected))
    return float(np.max(np.abs(weights.mean(axis=1) - expected) / np.maximum(error, 1e-12)))
