"""Ergun (2015) reproduced: its parts at tiny sizes, its verdicts, and its truth without shadows."""

from itertools import pairwise

import numpy as np
import pytest
from brdfkit.theses.ergun2015 import (
    convex_concavity,
    convex_gallery,
    convex_pictures,
    convex_rays,
    convex_settings,
    convex_study,
    convex_times,
    lobe_scenes,
    lobe_views,
    map_samplers,
    moving_parts,
    printed_forms,
    printed_lobes,
    sample_times,
    shapes,
)
from brdfkit.theses.ergun2015.lit_balls import FILTERS, METHODS, ROUGHNESSES, make_ward_bsdf
from brdfkit.theses.ergun2015.printed_lobes import (
    PrintedLobes,
    PrintedMixtures,
    find_kernel_kappa,
    warp_lobe,
)
from brdfkit.theses.ergun2015.printed_ray import enclose_in_sphere
from brdfkit.theses.ergun2015.unshadowed import make_unshadowed_integrator

import brdfkit as bk
from brdfkit.core.geometry.directions import from_angles
from brdfkit.lighting.spherical_gaussians.von_mises_fisher import density
from brdfkit.lighting.visibility.hull import make_hull
from brdfkit.mitsuba_bridge.bsdf.from_dictionary import eval_bsdf
from brdfkit.rendering.scene_input.loading import find_scene

CONVEX = [
    "convex_reads",
    "convex_times",
    "convex_pictures",
    "convex_settings",
    "convex_concavity",
    "convex_gallery",
    "moving_parts",
]


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
    exact, ours, inside, _ = bk.reproduce("ergun2015", parts=["convex_rays"]).claims
    assert exact.verdict.startswith("holds where the ε is 1e-05")
    assert ours.ours == "0 of 2,000 rays wrong"
    assert inside.verdict == "confirmed"
    assert "so mended, 0 of 2,000 rays are wrong" in inside.ours


@pytest.mark.quick
def test_a_hull_in_a_sphere_is_the_same_hull():
    """A stretched part is only moved and scaled: its corners lie on the sphere and the planes."""
    long = make_hull(np.random.default_rng(0).normal(size=(20, 3)) * [5, 1, 1] + [3, 0, 0])
    found = enclose_in_sphere(long)
    corners = found.vertices @ found.to_unit[:, :3].T + found.to_unit[:, 3]
    behind = corners @ found.planes[:, :3].T - found.planes[:, 3]
    assert np.linalg.norm(corners, axis=1).max() == pytest.approx(1)
    assert np.abs(behind.max(axis=0)).max() < 1e-9
    assert found.to_unit[:, :3] == pytest.approx(np.eye(3) / found.radius)


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
    monkeypatch.setattr(convex_concavity, "CONCAVITIES", settings["CONCAVITIES"])
    monkeypatch.setattr(moving_parts, "MOVES", 2)
    monkeypatch.setattr(moving_parts, "FRAMES", 2)
    monkeypatch.setattr(convex_times, "TURNS", 2)
    monkeypatch.setattr(convex_times, "PIXELS", 16)
    monkeypatch.setattr(convex_gallery, "SPP", 2)
    seen = []
    found = bk.reproduce(
        "ergun2015",
        path=tmp_path,
        parts=CONVEX,
        progress=lambda done, total: seen.append(done / total),
    )
    verdicts = {claim.says: claim for claim in found.claims}
    for form in ("the thesis's form", "brdfkit's form"):
        assert verdicts[f"No PSNR is below 39 dB: {form}."].verdict == "not run"
        assert "models/alligator.obj.xz" in verdicts[f"No PSNR is below 39 dB: {form}."].why
    assert verdicts["The larger the concavity, the fewer the parts."].ours == "8 4"
    assert seen == sorted(seen)
    assert len(found.written) == 7
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
    assert lobe_scenes.claim_near(grid).verdict == "confirmed"
    assert lobe_scenes.claim_best(decibels()).verdict == "not confirmed"  # all are equal
    grid = decibels(kde=falling - 20)
    assert lobe_scenes.claim_best(grid).verdict == "not confirmed"
    assert lobe_scenes.claim_matte(grid).verdict == "not confirmed"


@pytest.mark.quick
def test_a_middle_concavity_is_judged_by_mesh():
    """It counts from 1 dB above both ends."""
    curves = {"one": [30, 35, 40, 35, 34, 33], "two": [30, 35, 34, 33, 32, 31]}
    found = convex_concavity.claim_peak("f", curves | {"three": [40, 40.5, 40, 39, 38, 37]}, "")
    assert found.verdict == "holds where the mesh is not three"
    assert "one at 0.05 by 7.0 dB" in found.ours


@pytest.mark.quick
def test_convex_parts_are_judged_by_mesh_and_clearance():
    """Height fields are worse on a cow; the parts of a spot need a clearance of 0.03."""
    quality = {"spot": ((40.0, 41.0), (50.0, 50.0)), "cow": ((45.0, 45.0), (44.0, 44.0))}
    assert convex_pictures.claim_order("f", quality).verdict == "holds where the mesh is spot"
    clear = {
        name: dict.fromkeys(convex_pictures.CLEARANCES, linear)
        for name, ((linear, _), _) in quality.items()
    }
    assert convex_pictures.claim_clear(quality, clear).verdict == "confirmed"
    clear["spot"] = clear["spot"] | {0.01: 30.0, 0.02: 38.0}
    found = convex_pictures.claim_clear(quality, clear)
    assert found.verdict == "holds where the clearance is 0.03 or 0.04"
    assert "spot 38.0 dB at 0.02" in found.ours
    straight, power = [100, 80, 55, 30, 20, 0.1], [100, 60, 35, 15, 7, 3]
    found = convex_concavity.claim_fall({"one": straight, "two": power})
    assert found.verdict == "holds where the mesh is one"


@pytest.mark.quick
def test_the_verdicts_on_printed_forms_follow_their_grid():
    """Kernels win where filtered sampling has 16 directions, and tie elsewhere; 8 may be worse."""
    ours = decibels(gmm=np.full(len(ROUGHNESSES), 20.0))
    good, poor = (np.full((len(ROUGHNESSES), 2), value) for value in (40.0, 20.0))
    labels = [printed_forms.name_warped(a, f) for a in (0.5, 0.9) for f in FILTERS]
    labels += [printed_forms.name_kernels(n, a) for n in (8, 16, 32) for a in (0.5, 0.9)]
    labels += [printed_forms.name_sampling(d, b) for d in (16, 64, 128) for b in (0, 1)]
    grid = ours | {
        name: poor if "warped" in name or "16, bias" in name else good for name in labels
    }
    claim = printed_forms.claim_best_printed(grid)
    assert claim.verdict == "holds where the number of directions is 16"
    assert "kde 5 to 5, warped 0 to 0, filtered_sampling 0 to 5 of 5" in claim.ours
    grid |= {printed_forms.name_kernels(8, a): poor for a in (0.5, 0.9)}
    verdict = printed_forms.claim_best_printed(grid).verdict
    assert verdict == (
        "holds where the number of kernels is not 8 and the number of directions is 16"
    )
    assert printed_forms.claim_near_printed(grid).verdict == (
        "holds where the number of directions is 16"
    )


@pytest.mark.quick
def test_the_printed_lobe_has_wards_height_and_its_kernels_the_published_width(llvm_variant):
    """At the mirror direction it is BRDF × cosine; kernels of the digest's κ = 500 and 5."""
    theta = np.radians([0, 30, 60])
    kappa, weights = map(np.array, warp_lobe(llvm_variant.Float(np.cos(theta)), 0.1, 0.4))
    axes, wo = from_angles(theta, np.pi), from_angles(theta, 0)
    value = eval_bsdf(make_ward_bsdf(0.1), wo, axes)[:, 0] - 0.1 / np.pi
    assert weights * density(axes, axes, kappa) == pytest.approx(value * axes[:, 2], rel=1e-3)
    assert weights == pytest.approx(0.4 * np.cos(theta), rel=1e-3)
    kernels = np.array(find_kernel_kappa(llvm_variant.Float([500, 5]), 8))
    assert kernels == pytest.approx([999.667, 9.6908], rel=1e-4)


@pytest.mark.quick
def test_the_thesis_s_blocks_have_uniform_densities(llvm_variant):
    """As many densities as blocks, and no bias: the mean weight is the map's integral."""
    rgb = np.random.default_rng(3).random((16, 32, 3)) ** 8
    lamp = map_samplers.make_thesis_emitter(rgb, 12)
    sampler = lamp.map_sampler.sampler
    u = llvm_variant.Point2f(*np.random.default_rng(4).random((2, 4096)))
    _, _, found = sampler.sample(u, llvm_variant.Bool(True))
    assert len(np.unique(np.round(np.array(found), 5))) == 12
    linear = map_samplers.make_our_emitter(rgb, 12, "hyperbolic").map_sampler.sampler
    assert len(np.unique(np.round(np.array(linear.sample(u, llvm_variant.Bool(True))[2]), 5))) > 99
    by_blocks, by_sums = (
        map_samplers.draw_weights(by, 1 << 16)
        for by in (lamp, map_samplers.make_rival_emitter(rgb))
    )
    error = np.hypot(by_blocks.std(), by_sums.std()) / 256
    assert abs(by_blocks.mean() - by_sums.mean()) < 4 * error


def test_samples_of_a_map_at_a_small_size(llvm_variant, monkeypatch):
    monkeypatch.setattr(sample_times, "WIDTH", 64)
    monkeypatch.setattr(sample_times, "TURNS", 2)
    *_, memory = bk.reproduce("ergun2015", parts=["sample_times"]).claims
    assert memory.verdict == "confirmed"


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
    maps = "one", "two", "three"
    jumps = {(m, a): dict.fromkeys(kinds, 2.0) for m in maps for a in ("0.1", "0.2")}
    jumps["two", "0.2"] = dict.fromkeys(kinds, 1.0)
    found = lobe_views.claim_edges("Mixtures.", jumps, lobe_views.BLOCKS, True)
    assert found.verdict == "holds where the map is not two"
    assert found.ours == "in 5 of 6 settings; 1.0 to 2.0 times"
    assert lobe_views.claim_edges("None.", jumps, lobe_views.KERNELS, False).verdict == (
        "not confirmed"
    )


def test_printed_lobes_and_mixtures_light_a_ball_evenly(llvm_variant, monkeypatch):
    """In even light, kernels reflect what their lobe does, and a mixture, nearer to Ward, less.

    The nearest of three views shows as steps.
    """
    monkeypatch.setattr(printed_lobes, "VIEWS", 3)
    bsdf = make_ward_bsdf(0.2)
    made = find_scene("ball")(bsdf, (24, 24))
    light = llvm_variant.load_dict({"type": "constant"})
    small = {"type": "filtered_environment", "resolution": 32}
    monkeypatch.setattr(lobe_views, "make_integrator", lambda: llvm_variant.load_dict(small))
    kinds = [PrintedLobes(1), PrintedLobes(8), PrintedMixtures()]
    lobe, kernels, mixture = (lobe_views.render_by(made, light, kind) for kind in kinds)
    assert kernels == pytest.approx(lobe, abs=1e-3)
    middle = mixture[8:16, 8:16]
    assert middle.mean() == pytest.approx(lobe[8:16, 8:16].mean(), rel=0.2)
    assert len(np.unique(middle.round(2))) == 2 < len(np.unique(lobe[8:16, 8:16].round(2)))


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
