"""The page of gradients of shadow maps: its truth, and that gradients are as near as it says."""

import make_shadow_map_gradients as make
import numpy as np
import pytest
from shadow_map_gradients.page import off, slope
from shadow_map_gradients.scenes import LIGHTS

pytestmark = pytest.mark.usefixtures("llvm_variant")


@pytest.mark.parametrize("name", ["box", "ring", "plates"])
def test_the_integral_over_borders_is_what_rays_find(name):
    case = make.Case(name, "lamp")
    assert off(case.by_rays, case.true) < 0.015


def test_a_thing_that_goes_along_the_light_leaves_its_shadow_where_it_is():
    case = make.Case("ring", "sun")
    along = case.true @ LIGHTS["sun"]["direction"]
    assert np.abs(along).max() < 1e-6 < 0.5 < np.abs(case.true).max()


def test_averaged_moments_have_derivatives_and_comparisons_have_none():
    case = make.Case("box", "lamp")
    for its in ("variance", "moment", "exponential_variance"):
        found = case.by_map(filter=its)
        assert slope(case.true, found) == pytest.approx(1, abs=0.05)
        assert off(case.true, found) < 0.06
    assert not case.by_map(filter="percentage_closer").any()
    differences = case.by_differences_of_map(filter="percentage_closer")
    assert slope(case.true, differences) == pytest.approx(1, abs=0.05)
