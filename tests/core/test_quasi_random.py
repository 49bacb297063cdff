"""Quasi-random points are those of SciPy, whose import takes too long for a fit."""

import numpy as np
import pytest
from scipy.stats import qmc

from brdfkit.core.quasi_random import draw_halton_points, draw_sobol_points

pytestmark = pytest.mark.quick


@pytest.mark.parametrize("dimensions", [1, 3, 12])
def test_halton_points_are_those_of_scipy(dimensions):
    for seed in 0, 7:
        known = qmc.Halton(dimensions, rng=seed).random(95)
        np.testing.assert_array_equal(draw_halton_points(95, dimensions, seed), known)
    known = qmc.Halton(dimensions, scramble=False).random(95)
    np.testing.assert_array_equal(draw_halton_points(95, dimensions, None), known)


def test_a_generator_draws_other_halton_points_each_time():
    ours, scipys = np.random.default_rng(3), np.random.default_rng(3)
    for _ in range(2):
        known = qmc.Halton(4, rng=scipys).random(9)
        np.testing.assert_array_equal(draw_halton_points(9, 4, ours), known)


@pytest.mark.parametrize("dimensions", [1, 2, 3, 4])
def test_sobol_points_are_those_of_scipy(dimensions):
    for power, seed in (0, 0), (5, 1), (13, 0):
        known = qmc.Sobol(dimensions, rng=seed).random_base2(power)
        np.testing.assert_array_equal(draw_sobol_points(power, dimensions, seed), known)
