"""Statistical tests of samplers of directions, for the checks of emitters and phase functions.

A sampler is given as two functions. `draw(u, v)`, or `draw(u, v, w)`, maps a random point of the
unit square or cube to (direction, weight, density). `pdf(direction)` returns the density.
"""

from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray, JitFloat, JitVector, MitsubaObject
from brdfkit.core.jit.padding import pad

SIGNIFICANCE = 0.01  # probability that the χ² tests of a check together reject a correct sampler
SAMPLES = 400_000
# Numbers of the χ² histogram's cells, and of points in a cell at which the density is integrated,
# both along each axis; with fewer points the correct sampler of a small sun is rejected
CELLS, SUBCELLS = 101, 32
RINGS, POINTS = 512, 1024  # numbers of polar angles and azimuths of the quadrature


def run_chi_squared_test(
    draw: Callable[..., Any], pdf: Callable[[JitVector], JitFloat], tests: int, dimensions: int = 2
) -> float | None:
    """Test by Pearson's χ² test whether drawn directions have the density `pdf`.

    Returns the p-value, or None if the test rejects. `tests` is the number of such tests in a
    check, which divides its level of significance among them; `dimensions` is the number of
    arguments of `draw`.
    """
    import drjit as dr
    import mitsuba as mi
    from mitsuba.chi2 import ChiSquareTest, SphericalDomain

    def sample(u: Sequence[JitFloat]) -> tuple[JitVector, JitFloat]:
        direction, _, density = draw(*(u[i] for i in range(dimensions)))
        return direction, dr.select(density > 0, mi.Float(1), 0)

    test: MitsubaObject = ChiSquareTest(
        SphericalDomain(), sample, pdf, dimensions, SAMPLES, res=CELLS, ires=SUBCELLS
    )
    return test.p_value if test.run(SIGNIFICANCE, test_count=tests, quiet=True) else None


def draw_points(n: int, seed: int, dimensions: int = 2) -> tuple[JitFloat, ...]:
    """Draw `n` random points of the unit square or cube, as one `mi.Float` for each axis."""
    import mitsuba as mi

    u = np.random.default_rng(seed).random((dimensions, n), np.float32)
    return tuple(mi.Float(pad(row)) for row in u)


def make_sphere_quadrature() -> tuple[JitVector, FloatArray]:
    """Return a quadrature over the sphere: directions (mi.Vector3f) and solid angles (n,) [sr]."""
    import mitsuba as mi

    w, solid_angle = _make_grid()
    return mi.Vector3f(w), solid_angle


@cache
def _make_grid() -> tuple[FloatArray, FloatArray]:
    """Return directions (3, n), spaced evenly in both angles, and their solid angles (n,) [sr]."""
    theta = (np.arange(RINGS) + 0.5) / RINGS * np.pi
    phi = (np.arange(POINTS) + 0.5) / POINTS * 2 * np.pi
    theta, phi = (a.ravel() for a in np.meshgrid(theta, phi, indexing="ij"))
    w = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)])
    return w.astype(np.float32), np.sin(theta) * 2 * np.pi**2 / (RINGS * POINTS)


def broadcast_to_array(value: JitFloat, n: int) -> FloatArray:
    """Convert a value of Mitsuba to an array (n,), even if it is one number for all directions."""
    return np.broadcast_to(np.array(value, float).ravel(), n)


def count_standard_errors(weights: FloatArray, expected: FloatArray) -> float:
    """Return how many standard errors the mean of samples is away from its expected value.

    `weights` (channels, n) are the samples, `expected` (channels,) their expected means; the result
    is the largest deviation of a channel.
    """
    weights = np.asarray(weights, float)
    # Combines the errors of the mean and of the quadrature that gave `expected`
    error = np.hypot(weights.std(axis=1) / np.sqrt(weights.shape[1]), 1e-3 * np.abs(expected))
    return float(np.max(np.abs(weights.mean(axis=1) - expected) / np.maximum(error, 1e-12)))
