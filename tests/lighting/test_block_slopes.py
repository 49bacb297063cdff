"""Light within a block falls off along straight lines."""

import numpy as np
import pytest
from brdfkit.plugins.emitters.sampled_envmap import Cdf, Mip

from brdfkit.lighting.sampling.block_slopes import (
    STEEPEST,
    fit_slopes,
    line_density,
    sample_line_density,
)
from brdfkit.lighting.sampling.blocks import Blocks
from brdfkit.lighting.sampling.power_map import cell_power
from brdfkit.lighting.sampling.tree import Sums


@pytest.mark.quick
@pytest.mark.parametrize("slope", [-STEEPEST, -0.3, 0.0, 1e-6, 1.0, STEEPEST])
def test_a_line_is_drawn_by_the_inverse_of_its_integral(slope):
    for u in np.linspace(0, 1, 11).tolist():
        s = sample_line_density(u, slope)
        assert s + slope * (s**2 - s) / 2 == pytest.approx(u, abs=1e-12)
    assert line_density(sample_line_density(1.0, slope), slope) > 0


@pytest.mark.quick
def test_the_slopes_of_a_plane_are_found():
    """Of blocks of one cell, and of odd and even numbers of cells."""
    y, x = np.mgrid[0:9, 0:12]
    pixels = 5 + 0.3 * x - 0.2 * y
    cells = (pixels[:-1] + pixels[1:] + np.roll(pixels[:-1] + pixels[1:], -1, axis=1)) / 4
    boxes = np.array([[2, 3, 4, 5], [0, 8, 0, 4], [1, 2, 0, 8], [4, 10, 2, 3]])
    x0, x1, y0, y1 = boxes.T
    mean = 5 + 0.3 * (x0 + x1) / 2 - 0.2 * (y0 + y1) / 2
    expected = np.stack([0.3 * (x1 - x0) / mean, -0.2 * (y1 - y0) / mean], axis=1)
    np.testing.assert_allclose(fit_slopes(Sums(cells), pixels, boxes), expected)


@pytest.mark.quick
def test_no_line_ends_in_the_dark():
    """However the light falls, or where there is none, so that the density divides."""
    pixels = np.zeros((5, 8))
    pixels[1, 2] = 1
    boxes = np.array([[2, 3, 1, 2], [0, 8, 0, 4], [5, 7, 2, 4], [5, 6, 3, 4]])
    found = fit_slopes(Sums(cell_power(pixels)), pixels, boxes)
    np.testing.assert_array_equal(found[0], [-STEEPEST, -STEEPEST])
    np.testing.assert_array_equal(found[2:], 0)
    assert np.abs(found).max() <= STEEPEST


def test_a_sun_of_three_pixels_is_followed(llvm_variant):
    """The variance of light over density, beside that of a density that is constant in cells."""
    mi = llvm_variant
    brightness = np.full((33, 64), 0.1)
    brightness[8:11, 20:23] = 1e4
    light, weights = Mip(brightness), {}
    u = np.random.default_rng(0).random((2, 100_000), np.float32)
    samplers = {"blocks": Blocks(brightness, 64, "relative", "exact", "tree")}
    for name, sampler in (samplers | {"cells": Cdf(brightness)}).items():
        x, y, density = sampler.sample(mi.Point2f(mi.Float(u[0]), mi.Float(u[1])), True)
        weights[name] = np.array(light.density(x, y, True) / density)
    assert weights["blocks"].mean() == pytest.approx(1, abs=3e-3)
    assert weights["blocks"].var() < 0.03 < 0.2 < weights["cells"].var()
