"""The page of gradients of shadow maps: its truth, and that gradients are as near as it says."""

import make_shadow_map_gradients as make
import numpy as np
import pytest
from shadow_map_gradients.page import compute_relative_error, compute_slope
from shadow_map_gradients.scenes import LIGHTS

pytestmark = pytest.mark.usefixtures("llvm_variant")


@pytest.mark.parametrize("name", ["box", "ring", "plates"])
def test_the_integral_over_borders_is_what_rays_find(name):
    case = make.Case(name, "lamp")
    assert compute_relative_error(case.ray_derivatives, case.exact) < 0.015


def test_a_thing_that_goes_along_the_light_leaves_its_shadow_where_it_is():
    case = make.Case("ring", "sun")
    along = case.exact @ LIGHTS["sun"]["direction"]
    assert np.abs(along).max() < 1e-6 < 0.5 < np.abs(case.exact).max()


def test_averaged_moments_have_derivatives_and_comparisons_have_none():
    case = make.Case("box", "lamp")
    for its in ("variance", "moment", "exponential_variance"):
        found = case.differentiate_map(filter=its)
        assert compute_slope(case.exact, found) == pytest.approx(1, abs=0.05)
        assert compute_relative_error(case.exact, found) < 0.06
    assert not case.differentiate_map(filter="percentage_closer").any()
    differences = case.differentiate_map_numerically(filter="percentage_closer")
    assert compute_slope(case.exact, differences) == pytest.approx(1, abs=0.05)
