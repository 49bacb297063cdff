"""Bálint et al. (2019) reproduced: its parts at tiny sizes, its check values, and its verdicts."""

from types import SimpleNamespace

import numpy as np
import pytest

import brdfkit as bk
from brdfkit.core.jit import llvm

if llvm.find_loaded_version() < llvm.OLDEST:
    pytest.skip("needs LLVM", allow_module_level=True)

from brdfkit.theses.balint2019 import (
    against_rays,
    bands,
    bands_elsewhere,
    convex,
    error_bound,
    frame,
    grain,
    hard_edges,
    march_times,
    model_errors,
    right_epsilon,
    scenes,
    variants,
    whole_frames,
)
from brdfkit.theses.balint2019.dense import compute_dense_shadow
from brdfkit.theses.balint2019.measuring import read_shares
from brdfkit.theses.balint2019.view import View


def verdicts(*parts, **settings):
    """What a claim says → its verdict."""
    found = bk.reproduce("balint2019", parts=list(parts), **settings)
    return {claim.says: claim.verdict for claim in found.claims}


def test_all_check_values_are_equal_to_all_digits():
    """τ, a plane through the apex, and a sphere by 12 settings in two directions."""
    newton, *others = sorted(verdicts("check_values").items(), key=lambda item: item[1][0] != "n")
    assert newton[1] == "not confirmed"
    assert [verdict for _, verdict in others] == ["confirmed"] * 3


def test_the_bound_holds_and_does_not_as_printed(monkeypatch):
    monkeypatch.setattr(error_bound, "CONES", 100)
    monkeypatch.setattr(error_bound, "PRINTED_CONES", 20)
    monkeypatch.setattr(error_bound, "EPSILONS", (10,))
    first, second, practice, *others = verdicts("error_bound").values()
    assert [first, second, *others] == ["confirmed"] * 3 + ["not confirmed"]
    assert practice.startswith("holds where the march is base or linear")


def test_errors_of_the_model_have_their_signs(monkeypatch, tmp_path):
    monkeypatch.setattr(model_errors, "SIZE", 32)
    monkeypatch.setattr(model_errors, "RAYS", 64)
    monkeypatch.setattr(hard_edges, "SIZE", 64)
    found = verdicts("hard_edges", "model_errors", path=tmp_path)
    assert set(found.values()) == {"confirmed"}
    page = (tmp_path / "balint2019.md").read_text(encoding="utf-8")
    assert "| several | Figure 6.19 |" in page
    assert len(list(tmp_path.glob("*.png"))) == 2


def test_frames_and_tables_at_a_small_size(monkeypatch):
    settings = {
        frame: {"SIZE": 48, "RAYS": (1, 3, 16, 64, 128, 512), "TRUE_RAYS": 512, "TIMES": 1},
        against_rays: {"RAYS": (1, 3, 16, 64, 128, 512), "SCENES": (scenes.cube,)},
        march_times: {"INVERSES": (10,), "TIMES": 1},
        variants: {
            "INVERSES": (10,),
            "SIZE": 16,
            "SCENES": {"table_6_1": scenes.simple},
        },
        convex: {
            "SIZE": 16,
            "SCENES": {"simple": scenes.simple},
            "TABLES": {"table_6_1": "simple"},
        },
        whole_frames: {"SIZE": 16, "TIMES": 2},
        bands: {"INVERSES": (2, 8, 16, 32, 64)},
        bands_elsewhere: {
            "AWAY": (2,),
            "NEAR_RADII": (0.25, 4.0),
            "RADII": (0.25, 4.0),
            "SCENES": {"simple": scenes.simple},
        },
        right_epsilon: {"SIZE": 16, "PRINTED": {0.25: 16, 4.0: 64}},
    }
    for module, values in settings.items():
        for name, value in values.items():
            monkeypatch.setattr(module, name, value)
    found = verdicts("against_rays", "variants", "convex", "right_epsilon")
    assert found["It is much more accurate than other shadows of one march."] == "confirmed"
    assert found["`linear` is as good as `base`, and `discrete` is much worse."] == "confirmed"
    assert found["Soft shadows are computed in real time."] == "not run"
    assert found["Lights of radius 0.25, 0.5, 1, 2 and 4 need these ε."] == "not stated"
    assert len(found) == 25


@pytest.mark.quick
def test_printed_times_are_those_of_the_shadows():
    times = march_times.read_printed_times("table_6_1")
    assert times[0, 0, march_times.LINEAR] == 1
    assert times[0, 0, march_times.BASE] == pytest.approx((3.2398 - 0.7005) / (1.4602 - 0.7005))


@pytest.mark.quick
def test_a_row_that_fails_is_counted():
    times = np.ones((1, 8, 4))
    times[..., march_times.BASE] = 2
    times[0, 3, march_times.BASE] = 0.5
    claim = variants.claim_base({"table_6_1": times}, {"table_6_1": times})
    assert (claim.printed, claim.verdict) == ("7 of 8 rows", "confirmed")  # in the mean
    others = {"table_6_1": times, "table_6_2": 1 / times}
    assert variants.claim_base(others, others).verdict == "holds where the scene is simple"
    slowest = variants.claim_slowest({"table_6_1": times}, {"table_6_1": times})
    assert (slowest.ours, slowest.verdict) == ("7 of 8", "not confirmed")


@pytest.mark.quick
def test_an_interval_that_has_1_decides_nothing():
    assert variants.takes_longer([2.0, 2.1], [1.0, 1.0])
    assert not variants.takes_longer([1.0, 2.0], [1.1, 1.0])


def test_convex_steps_outside_keep_the_bound():
    """They are at most ε above the dense search, and need more evaluations than ours everywhere."""
    view = View(scenes.simple(), 64)
    field, cone = view.scene.field, view.make_cones(0.5)
    model = read_shares(compute_dense_shadow(field, cone))
    outside, everywhere = (march(field, cone, 1 / 20) for march in convex.FORMS.values())
    off = read_shares(outside) - model
    assert off.min() > -1e-3
    assert off.max() < 1 / 20 + 1e-3
    assert np.mean(outside.evaluations) > np.mean(everywhere.evaluations)


@pytest.mark.quick
def test_grains_are_pixels_unlike_their_neighbours():
    view = SimpleNamespace(make_image=lambda values, other: np.reshape(values, (5, 5)) * 1.0)
    steps, grains = np.repeat([0, 0.3, 0.6, 0.9, 1], 5), np.tile([0, 1], 13)[:25]
    assert grain.measure_grain(view, steps, np.full(25, 0.5)) == 0
    assert grain.measure_grain(view, grains, np.full(25, 0.5)) == 1


@pytest.mark.quick
def test_bands_are_jumps_of_the_error():
    image = np.zeros((4, 4))
    image[:, 2:] = 0.5
    assert bands.measure_jumps(image).tolist() == [[0, 0.5, 0]] * 3


@pytest.mark.quick
def test_an_edge_is_as_wide_as_its_ramp():
    x = np.arange(64) - 32.0
    for wide in (2, 8):
        share = np.clip(x / wide + 0.5, 0, 1) + np.zeros((64, 1))
        assert hard_edges.measure_edge_width(share) == pytest.approx(wide, abs=1.1)


def test_a_view_sees_points_off_the_surface():
    """Whose balls are empty, and touch it."""
    view = View(scenes.cube(), 16)
    distances = view.scene.field(np.transpose(view.points))
    assert np.allclose(distances, view.ball, atol=1e-5)
    assert view.seen.all()
    assert view.facing.max() <= 1 + 1e-6
