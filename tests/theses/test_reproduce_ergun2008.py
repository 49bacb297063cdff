"""Ergun (2008) reproduced: its parts at small sizes, its check values, and its misprints."""

import numpy as np
import pytest

import brdfkit as bk
from brdfkit.core.jit import llvm

if llvm.find_loaded_version() < llvm.OLDEST:
    pytest.skip("needs LLVM", allow_module_level=True)

from brdfkit.theses.ergun2008 import (
    by_volumes,
    printed,
    stencil,
    table_1,
    table_4,
    trapezoid,
    views,
)


def verdicts(*parts):
    """What a claim says → its verdict."""
    found = bk.reproduce("ergun2008", parts=list(parts))
    return {claim.says: claim.verdict for claim in found.claims}


def test_values_and_misprints():
    """All formulas give the values that were computed apart; of those as printed, none does."""
    values = verdicts("check_values")
    assert len(values) == 9
    assert set(values.values()) == {"confirmed"}
    *formulas, means = verdicts("misprints").values()
    assert formulas == ["not confirmed"] * 7
    assert means == "confirmed"


def test_maps_are_made_once_for_all_biases(monkeypatch):
    monkeypatch.setattr(views, "SIZE", 32)
    view = views.View.load("compact", "V1", 1)
    how = {"filter": "variance", "partition": "parallel_split", "resolution": 64}
    found = list(view.compute_lit_by_bias(views.BIASES.values(), **how))
    for lit, bias in zip(found, views.BIASES.values(), strict=True):
        np.testing.assert_array_equal(lit, view.compute_lit(view.make_shadow(bias=bias, **how)))
    assert (found[1] != found[-1]).any()


def test_tables_and_volumes_at_a_small_size(monkeypatch):
    monkeypatch.setattr(table_1, "SCENES", ("objects_on_a_ground",))
    monkeypatch.setattr(table_1, "RESOLUTIONS", (128,))
    monkeypatch.setattr(table_4, "SCENES", ("compact",))
    monkeypatch.setattr(table_4, "RESOLUTIONS", (128,))
    monkeypatch.setattr(table_4, "BIASES", {"1": views.BIASES["0.001"]})
    monkeypatch.setattr(views, "SIZE", 64)
    monkeypatch.setattr(views, "RESOLUTION", 128)
    monkeypatch.setattr(by_volumes, "SIZE", 64)
    monkeypatch.setattr(stencil, "NAMES", ("objects_on_a_ground",))
    monkeypatch.setattr(stencil, "VIEWS", ("V1",))
    found = verdicts("stencil", "table_1", "depth_curves", "table_4")
    assert found["Stencil volumes are exact in every pixel, by depth-fail."] == "confirmed"
    assert found["POSM uses the map best."] == "confirmed"
    assert found["PSM uses it worst."] == "not confirmed"
    assert found["Uniform, focused, PSM and LiSPSM have nearly the same curves."] == "not confirmed"
    assert len(found) == 25


@pytest.mark.quick
def test_printed_tables_are_means_of_their_cells():
    cells = printed.read_printed_table("texture_use")["plane_optimal"]
    mean, relative = printed.average_cells(cells)
    assert mean == pytest.approx(0.05925)
    assert relative == pytest.approx(0.02175)


@pytest.mark.quick
def test_the_printed_n_t():
    """Acceptance check 3 by the eight steps."""
    expected = [[4, -4 / 15, 0, -0.04], [0, 8 / 3, 0, -0.6], [0, 0, 1, 0], [0, -4 / 3, 0, 1.8]]
    found = trapezoid.map_trapezoid_to_square()
    np.testing.assert_allclose(found / found[2, 2], expected, atol=1e-12)
