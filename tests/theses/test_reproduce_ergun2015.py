"""Ergun (2015) reproduced: its parts at tiny sizes, its verdicts, and its truth without shadows."""

from itertools import pairwise

import numpy as np
import pytest
from brdfkit.theses.ergun2015 import (
    convex_rays,
    convex_settings,
    convex_study,
    lobe_scenes,
    lobe_views,
    moving_parts,
    shapes,
)
from brdfkit.theses.ergun2015.lit_balls import FILTERS, METHODS, ROUGHNESSES, make_ward_bsdf
from brdfkit.theses.ergun2015.unshadowed import make_unshadowed_integrator

import brdfkit as bk
from brdfkit.lighting.visibility.hull import make_hull
from brdfkit.rendering.scene_input.loading import find_scene

CONVEX = ["convex_reads", "convex_pictures", "convex_settings", "moving_parts"]


@pytest.fixture(autouse=True)
def no_data(monkeypatch):
    """The parts take what brdfkit brings, and keep no meshes between tests."""
    monkeypatch.delenv("BRDFKIT_DATA", raising=False)
    convex_study.make_studies.cache_clear()
    yield
    convex_study.make_studies.cache_clear()


@pytest.mark.quick
def test_without_coacd_its_claims_are_not_run(llvm_variant, monkeypatch):
    monkeypatch.setattr(convex_study, "find_spec", lambda name: None)
    found = bk.reproduce("ergun2015", parts=CONVEX)
    assert {claim.verdict for claim in found.claims} == {"not run"}
    assert all("pip install 'brdfkit[visibility]'" in claim.why for claim in found.claims)


def test_rays_at_a_small_size(monkeypatch):
    for name, value in {"RAYS": 2000, "CORNERS": (12,), "SIDES": (8, 32)}.items():
        monkeypatch.setattr(convex_rays, name, value)
    lookups, exact, _ = bk.reproduce("ergun2015", parts=["convex_rays"]).claims
    assert lookups.verdict == "confirmed"
    assert exact.ours == "0 of 2,000 rays wrong"


def quarters(points, faces, concavity=0.03):
    """A ring in so many parts, as a decomposition of it would be."""
    angle = np.arctan2(points[:, 1] - points[:, 1].mean(), points[:, 0])
    count = 8 if concavity < 0.1 else 4
    edges = np.linspace(-np.pi, np.pi, count + 1)
    near = [(angle >= a - 0.05) & (angle <= b + 0.05) for a, b in pairwise(edges)]
    return [make_hull(points[n]) for n in near]


def test_convex_parts_of_a_torus_at_a_small_size(llvm_variant, monkeypatch, tmp_path):
    """The meshes are missing, so that a torus stands in, and C9 is not run."""
    monkeypatch.setattr(convex_study, "decompose", quarters)
    monkeypatch.setattr(convex_study, "find_spec", lambda name: True)
    monkeypatch.setattr(convex_study, "SIZE", 24)
    monkeypatch.setattr(shapes, "COLUMNS", 13)
    settings = {"CONCAVITIES": (0.03, 0.2), "RESOLUTIONS": (8,), "CLEARANCES": (0.02,)}
    for name, value in settings.items():
        monkeypatch.setattr(convex_settings, name, value)
    monkeypatch.setattr(moving_parts, "MOVES", 2)
    monkeypatch.setattr(moving_parts, "FRAMES", 2)
    seen = []
    found = bk.reproduce(
        "ergun2015",
        path=tmp_path,
        parts=CONVEX,
        progress=lambda done, total: seen.append(done / total),
    )
    verdicts = {claim.says: claim for claim in found.claims}
    assert verdicts["No PSNR is below 39 dB."].verdict == "not run"
    assert "models/alligator.obj.xz" in verdicts["No PSNR is below 39 dB."].why
    assert verdicts["The larger the concavity, the fewer the parts."].ours == "8 4"
    assert seen == sorted(seen)
    assert len(found.written) == 4
    assert "| torus |" in (tmp_path / "ergun2015.md").read_text(encoding="utf-8")


def decibels(**by_method):
    """PSNRs (scenes, 2) by kind as a grid gives them, of one scene per roughness."""
    alike = dict.fromkeys(METHODS, np.full(len(ROUGHNESSES), 40.0)) | by_method
    return {f"{m}, {f}": np.transpose([alike[m]] * 2) for m in METHODS for f in FILTERS}


@pytest.mark.quick
def test_the_verdicts_on_a_grid_follow_its_figures():
    falling = np.linspace(45, 25, len(ROUGHNESSES))
    grid = decibels(warped=falling, filtered_sampling=falling + 1)
    assert lobe_scenes.claim_best(grid).verdict == "confirmed"
    assert lobe_scenes.claim_matte(grid).verdict == "confirmed"
    grid = decibels(kde=falling - 20)
    assert lobe_scenes.claim_best(grid).verdict == "not confirmed"
    assert lobe_scenes.claim_matte(grid).verdict == "not confirmed"


@pytest.mark.quick
def test_an_edge_is_seen_where_the_view_changes(monkeypatch):
    size = 32
    monkeypatch.setattr(lobe_views, "SIZE", size)
    error = np.random.default_rng(0).normal(size=(size, size, 3))
    views, seen = np.arange(size)[:, None] // 8 + np.zeros((1, size)), np.ones((size, size), bool)
    assert lobe_views.measure_view_jumps(error, views, seen) == pytest.approx(1, abs=0.15)
    assert lobe_views.measure_view_jumps(error + 9 * views[..., None], views, seen) > 5


@pytest.mark.quick
def test_edges_are_judged_by_map_and_roughness():
    kinds = lobe_views.KINDS
    jumps = {(m, a): dict.fromkeys(kinds, 2.0) for m in ("one", "two") for a in ("0.1", "0.2")}
    jumps["two", "0.2"] = dict.fromkeys(kinds, 1.0)
    found = lobe_views.claim_edges("Mixtures.", jumps, lobe_views.BLOCKS, True)
    assert found.verdict == "holds where the map is one"
    assert found.ours == "in 3 of 4 settings; 1.0 to 2.0 times"
    assert lobe_views.claim_edges("None.", jumps, lobe_views.KERNELS, False).verdict == (
        "not confirmed"
    )


def test_the_lobes_of_the_nearest_view_are_rendered(llvm_variant):
    """The replaced look-up of views changes the picture, and is taken away again."""
    made = find_scene("ball")(make_ward_bsdf(0.2), (16, 16))
    light = llvm_variant.load_dict({"type": "constant"})
    entries = {"type": "filtered_environment", "method": "warped", "resolution": 32}
    lobes = llvm_variant.load_dict(entries).shading.fit_lobes(make_ward_bsdf(0.2))
    between, nearest, again = (
        lobe_views.render_with_lobes(made, light, llvm_variant.load_dict(entries), lobes, which)
        for which in (False, True, False)
    )
    assert np.abs(nearest - between).max() > 1e-4
    assert (again == between).all()


def test_the_truth_without_shadows_has_none(llvm_variant):
    """A matte cup in even light shows its albedo times the light, inside and out; by halves of
    the samples that the balance heuristic weighs."""
    mi = llvm_variant
    grey = {"type": "diffuse", "reflectance": 0.4}
    cup = {"type": "cylinder", "bsdf": {"type": "twosided", "bsdf": grey}}
    film = {"type": "hdrfilm", "width": 16, "height": 16, "rfilter": {"type": "box"}}
    camera = mi.ScalarTransform4f().look_at([3, 0, 3], [0, 0, 0.5], [0, 0, 1])
    scene = mi.load_dict(
        {
            "type": "scene",
            "cup": cup,
            "light": {"type": "constant", "radiance": 0.5},
            "sensor": {"type": "perspective", "fov": 30, "to_world": camera, "film": film},
        }
    )
    picture = np.array(make_unshadowed_integrator(4096, 0).render(scene, seed=0, spp=1))[..., :3]
    cup = np.abs(picture - 0.5) > 0.1
    assert cup.mean() > 0.1
    assert picture[cup].mean() == pytest.approx(0.2, rel=0.005)
    again = np.array(make_unshadowed_integrator(4096, 0).render(scene, seed=0, spp=1))[..., :3]
    assert (again == picture).all()
