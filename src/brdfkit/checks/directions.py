"""Tests samplers of directions over the sphere, for the checks of emitters and phase functions.

A sampler is given as two functions. `draw(u, v)`, or `draw(u, v, w)`, takes a point of the unit
square or cube to (direction, weight, density). `pdf(direction)` returns the density.
"""

from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray, JitFloat, JitVector, MitsubaObject
from brdfkit.core.jit.padding import pad

SIGNIFICANCE = 0.01
SAMPLES = 400_000
# Cells of the χ² test's histogram, and points to integrate the density in a cell, both along each
# axis; with fewer points the correct sampler of a small sun is rejected
CELLS, SUBCELLS = 101, 32
RINGS, POINTS = 512, 1024  # polar angles and azimuths of the quadrature


def chi_squared(
    draw: Callable[..., Any], pdf: Callable[[JitVector], JitFloat], tests: int, dimensions: int = 2
) -> float | None:
    """Return the p-value of Pearson's χ² test that directions have their density.

    None stands for a rejection. `tests`: the number of such tests in a check, which share the level
    of significance; `dimensions`: the number of arguments of `draw`.
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
    """Draw `n` random points in the unit square or cube, as one `mi.Float` for each axis."""
    import mitsuba as mi

    u = np.random.default_rng(seed).random((dimensions, n), np.float32)
    return tuple(mi.Float(pad(row)) for row in u)


def make_quadrature() -> tuple[JitVector, FloatArray]:
    """Return directions over the sphere, a `mi.Vector3f`, and their solid angles (n,) [sr]."""
    import mitsuba as mi

    w, solid_angle = _make_grid()
    return mi.Vector3f(w), solid_angle


@cache
def _make_grid() -> tuple[FloatArray, FloatArray]:
    """Return directions (3, n) evenly spaced in both angles, and their solid angles (n,) [sr]."""
    theta = (np.arange(RINGS) + 0.5) / RINGS * np.pi
    phi = (np.arange(POINTS) + 0.5) / POINTS * 2 * np.pi
    theta, phi = (a.ravel() for a in np.meshgrid(theta, phi, indexing="ij"))
    w = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)])
    return w.astype(np.float32), np.sin(theta) * 2 * np.pi**2 / (RINGS * POINTS)


def to_numbers(value: JitFloat, n: int) -> FloatArray:
    """Return a value of Mitsuba as an array (n,), also if it is a constant for all directions."""
    return np.broadcast_to(np.array(value, float).ravel(), n)


def deviation(weights: FloatArray, expected: FloatArray) -> float:
    """Return the deviation of the mean of `weights` (channels, n) from `expected` (channels,).

    It is counted in standard errors, and is the largest over the channels.
    """
    weights = np.asarray(weights, float)
    # The error of the mean, and of the quadrature that gave `expected`
    error = np.hypot(weights.std(axis=1) / np.sqrt(weights.shape[1]), 1e-3 * np.abs(expected))
    return float(np.max(np.abs(weights.mean(axis=1) - expected) / np.maximum(error, 1e-12)))
