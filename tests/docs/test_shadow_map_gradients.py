"""The page of gradients of shadow maps: its truth, and that gradients are as near as it says."""

import make_shadow_map_gradients as make
import numpy as np
import pytest
from shadow_map_gradients.page import compute_relative_error, compute_slope
from shadow_map_gradients.scenes import LIGHTS, SCENES

pytestmark = pytest.mark.usefixtures("llvm_variant")


@pytest.mark.parametrize("name", ["box", "ring", "plates"])
def test_the_integral_over_borders_is_what_rays_find(name):
    case = make.Case(name, "lamp")
    assert compute_relative_error(case.ray_derivatives, case.exact) < 0.015


def test_a_thing_that_goes_along_the_light_leaves_its_shadow_where_it_is():
    case = make.Case("ring", "sun")
    along = case.exact @ LIGHTS["sun"]["direction"]
    assert np.abs(along).max() < 1e-6 < 0.5 < np.abs(case.exact).max()


@pytest.mark.parametrize("name", SCENES)
def test_exponential_variances_have_95_percent_of_the_derivative_in_every_scene(name):
    """Thin bars, and three depths in one window, where a steep bound outweighs all others, too."""
    case = make.Case(name, "lamp")
    for how in ({}, {"projection": "plane_optimal"}, {"negative_exponent": 0}):
        found = case.differentiate_map(filter="exponential_variance", **how)
        cosine = (found * case.exact).sum() / np.linalg.norm(found) / np.linalg.norm(case.exact)
        assert min(compute_slope(case.exact, found), cosine) > 0.95, how


def test_averaged_moments_have_derivatives_and_comparisons_have_none():
    case = make.Case("box", "lamp")
    for its in ("variance", "moment", "exponential_variance"):
        found = case.differentiate_map(filter=its)
        assert compute_slope(case.exact, found) == pytest.approx(1, abs=0.03)
        assert compute_relative_error(case.exact, found) < 0.05
    assert not case.differentiate_map(filter="percentage_closer").any()
    differences = case.differentiate_map_numerically(filter="percentage_closer")
    assert compute_slope(case.exact, differences) == pytest.approx(1, abs=0.05)
