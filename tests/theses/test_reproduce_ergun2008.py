"""Ergun (2008) reproduced: its parts at small sizes, its check values, and its misprints."""

import numpy as np
import pytest

import brdfkit as bk
from brdfkit.core.jit import llvm

if llvm.find_loaded_version() < llvm.OLDEST:
    pytest.skip("needs LLVM", allow_module_level=True)

from brdfkit.theses.ergun2008 import (
    by_volumes,
    degenerate_quads,
    printed,
    resolution_matched,
    stencil,
    table_1,
    table_4,
    thesis_forms,
    trapezoid,
    views,
)

from brdfkit.core.projective.camera import CUBE
from brdfkit.core.projective.homogeneous import project_points
from brdfkit.shadows.maps.partition import Setup
from brdfkit.shadows.maps.projections import focused
from brdfkit.shadows.maps.resolution import texel_area_in_pixels


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
    monkeypatch.setattr(degenerate_quads, "NAMES", ("objects_on_a_ground",))
    monkeypatch.setattr(degenerate_quads, "VIEWS", ("V1",))
    monkeypatch.setattr(degenerate_quads, "AROUND", (8, 32))
    monkeypatch.setattr(resolution_matched, "SCENES", ("compact_from_afar",))
    parts = "stencil", "degenerate_quads", "table_1", "table_4", "resolution_matched"
    found = verdicts(*parts)
    assert found["Stencil volumes are exact in every pixel, by depth-fail."] == "confirmed"
    assert found["Quads of no width that a vertex program opens give right volumes."] == "confirmed"
    assert found["POSM uses the map best."] == "confirmed"
    assert found["Texture use, best first."] == "not confirmed"
    assert found["What costs most is the analysis of the scene."] == "not run"
    assert len(found) == 28


@pytest.mark.quick
@pytest.mark.parametrize("near", [0.1, 1.0])
def test_the_thesis_s_forms_of_projections(near, llvm_variant):
    """A window about a place before the eye, a cone about the cube, a trapezoid about a frustum."""
    placement = views.load_placements("compact")["V1"]
    camera, (z_n, z_f) = placement.camera, placement.visible_depths
    found = thesis_forms.make_thesis_forms(placement, near)
    middle = camera.position + 0.6 * z_f * camera.direction
    across = np.cross(placement.light.point[:3], [0, 0, 1])
    ends = middle + z_f * across / np.linalg.norm(across) * [[0], [1], [-1]]
    places = project_points(found["uniform"].matrix, ends)[:, :2]
    np.testing.assert_allclose(np.linalg.norm(places, axis=1), [0, 1, 1], atol=1e-9)

    eye = camera.replace_near_and_far(near * z_n, z_f)
    cube = eye.move_behind(placement.relevant_body.corners).matrix
    corners = project_points(np.linalg.inv(cube), CUBE)
    places = project_points(found["perspective"].matrix, corners)
    assert np.hypot(*places[:, :2].T).max() == pytest.approx(1)

    places = project_points(found["trapezoidal"].matrix, eye.find_frustum_corners())[:, :2]
    np.testing.assert_allclose([places.min(axis=0), places.max(axis=0)], [[-1, -1], [1, 1]])
    middles = places[:4].mean(axis=0), places[4:].mean(axis=0)
    assert middles[0][1] > middles[1][1]  # the near plane is at the narrow side, above


def test_each_pixel_has_a_page_whose_texels_are_no_larger(monkeypatch):
    monkeypatch.setattr(views, "SIZE", 64)
    view = views.View.load("compact", "V1", 1)
    setup = Setup(view.scene, view.placement, focused.make_projection, 64)
    partition, table = resolution_matched.make_pages(setup, view, 16)
    seen, count = view.seen, len(partition.parts)
    valid = np.array(seen.si.is_valid())
    part = np.array(partition.find_part(seen.si.p))
    assert part[valid].max() == count - 1 < count == table.max()  # elsewhere there is no page
    camera = thesis_forms.Projection.from_matrix(view.placement.camera.matrix, view.placement.light)
    picture = camera.make_opaque(), (64, 64)
    for i, page in enumerate(partition.parts):
        texels = page.projection.make_opaque(), page.resolution
        area = np.array(texel_area_in_pixels(texels, picture, seen.si.p, seen.si.n))
        assert area[valid & (part == i)].max() < 1 + 1e-4


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
