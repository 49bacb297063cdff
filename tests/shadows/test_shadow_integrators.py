"""The integrators with shadows in scenes that are not nice: the picture of shadow rays, or one
sentence; and the same scenes compared."""

import os
import signal

import mitsuba as mi
import numpy as np
import pytest
from shadow_scenes import light

import brdfkit as bk
from brdfkit.core.errors import BrdfkitError
from brdfkit.shadows.maps.light_shadow import ShadowMap

pytestmark = pytest.mark.usefixtures("llvm_variant")
INTEGRATORS = "shadow_map", "shadow_volume", "hybrid_shadow"
RAYS = {"type": "direct", "emitter_samples": 1, "bsdf_samples": 0}
SIZE = 32


def look_at(origin, target):
    return mi.ScalarTransform4f().look_at(origin, target, [0.1, 0.2, 1])


def camera(origin=(4, -6, 5), target=(0, 0, 0.5), film=None, **more):
    film = {"type": "hdrfilm", "width": SIZE, "height": SIZE, "rfilter": {"type": "box"}} | (
        film or {}
    )
    to_world = look_at(list(origin), list(target))
    return {"type": "perspective", "fov": 40, "to_world": to_world, "film": film, **more}


def spot(origin, target, angle):
    how = {"cutoff_angle": angle, "beam_width": 0.99 * angle}
    return {"type": "spot", "to_world": look_at(origin, target), **how}


def scene(lights, *cameras, **shapes):
    t = mi.ScalarTransform4f
    usual = {
        "ground": {"type": "rectangle", "to_world": t().scale(4)},
        "ball": {"type": "sphere", "center": [0, 0, 1], "radius": 0.8},
    }
    lights = {f"light_{i}": each for i, each in enumerate(lights)}
    cameras = {f"camera_{i}": each for i, each in enumerate(cameras or [camera()])}
    return mi.load_dict({"type": "scene", **cameras, **lights, **usual, **shapes})


def picture(of, integrator, **how):
    return np.array(mi.load_dict({"type": integrator, **how}).render(of, spp=4))


def triangle(*corners):
    shape = mi.Mesh("sail", 3, 1)
    parameters = mi.traverse(shape)
    parameters["vertex_positions"] = np.ravel(corners).astype(np.float32)
    parameters["faces"] = np.arange(3, dtype=np.uint32)
    parameters.update()
    return shape


AWAY = (0, 0, 8), (0, 0, 20)
SCENES = {
    "an alpha channel": lambda: scene(
        [light("directional")], camera(target=(0, 0, 4), film={"pixel_format": "rgba"})
    ),
    "a window of the film": lambda: scene(
        [light("point")],
        camera(film={f"crop_{name}": 12 for name in ("offset_x", "offset_y", "width", "height")}),
    ),
    "a spot that shines on nothing": lambda: scene([spot(*AWAY, 20)]),
    "a camera that sees nothing": lambda: scene([light("point")], camera(target=(8, -12, 10))),
    "a camera that looks over all": lambda: scene([light("point")], camera((0, 0, 3), (0, 8, 8))),
    "a dark light": lambda: scene([{**light("point"), "intensity": 0.0}]),
    "a sun in the plane of the ground": lambda: scene([light([1, 0.2, 0])]),
    "from afar": lambda: scene(
        [light("directional")], camera((4e3, -6e3, 5e3), fov=0.04, far_clip=1e5)
    ),
}


@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("name", SCENES)
def test_the_picture_is_that_of_rays(name, integrator):
    of = SCENES[name]()
    fine = {"resolution": 512} if integrator == "hybrid_shadow" else {}
    found, exact = picture(of, integrator, **fine), np.array(mi.load_dict(RAYS).render(of, spp=4))
    assert found.shape == exact.shape
    different = np.any(np.abs(found - exact) > 0.25 * exact.max(), axis=2)
    assert different.mean() < 0.01
    assert found.mean() == pytest.approx(exact.mean(), rel=0.02)


def test_one_light_that_reaches_nothing_leaves_the_others_as_they_are():
    alone, beside = (scene([light("directional"), *more]) for more in ([], [spot(*AWAY, 20)]))
    for integrator in INTEGRATORS:
        np.testing.assert_allclose(picture(alone, integrator), picture(beside, integrator))


@pytest.mark.parametrize("angle", [85, 120, 179])
def test_a_spot_too_wide_for_one_map_is_right_or_refused(angle):
    """Of its light, what is beyond 80° had no shadow: the wall behind the ball was lit."""
    t = mi.ScalarTransform4f
    wall = t().translate([4, 0, 2]).rotate([0, 1, 0], -90).scale([2, 4, 1])
    shapes = {
        "ball": {"type": "sphere", "center": [2, 0, 1.3], "radius": 0.5},
        "wall": {"type": "rectangle", "to_world": wall},
    }
    down = spot([0, 0, 1.5], [0.001, 0, 0], angle)
    of = scene([down], camera((-3, -4, 3), (4, 0, 1)), **shapes)
    exact = np.array(mi.load_dict(RAYS).render(of, spp=4))
    for how in ({"integrator": "shadow_map", "partition": "cube"}, {"integrator": "shadow_volume"}):
        assert np.abs(picture(of, **how) - exact).sum() / exact.sum() < 0.005
    for integrator in ("shadow_map", "hybrid_shadow"):
        with pytest.raises(BrdfkitError, match="one shadow map cannot look all around"):
            picture(of, integrator)
    outside = scene([spot([-4, 2, 8], [0, 0, 0], angle)])
    exact = np.array(mi.load_dict(RAYS).render(outside, spp=4))
    assert np.abs(picture(outside, "shadow_map") - exact).sum() / exact.sum() < 0.01


def test_a_lamp_on_a_surface_is_not_shadowed_by_that_surface():
    """Its triangle has no volume; rays do not meet it, either."""
    of = scene([{"type": "point", "position": [-2, -2, 0]}])
    exact = np.array(mi.load_dict(RAYS).render(of, spp=4))
    assert exact.any()
    np.testing.assert_allclose(picture(of, "shadow_volume"), exact, atol=0.01 * exact.max())


@pytest.fixture
def variant():
    """A function that sets a variant; afterwards the old one is back."""
    before = mi.variant()
    yield mi.set_variant
    mi.set_variant(before)


@pytest.mark.parametrize(
    "chosen", ["llvm_ad_mono", "llvm_ad_spectral", "llvm_ad_spectral_polarized"]
)
def test_a_sun_without_an_irradiance_is_a_sun_in_every_variant(chosen, variant):
    variant(chosen)
    of = scene([light("directional")])
    exact = np.array(mi.load_dict(RAYS).render(of, spp=4))
    for integrator in INTEGRATORS:
        assert picture(of, integrator).mean() == pytest.approx(exact.mean(), rel=0.02)


def test_techniques_are_not_compared_pixel_by_pixel(variant):
    variant("scalar_rgb")
    with pytest.raises(BrdfkitError, match="compare does not run in scalar_rgb"):
        bk.shadows.compare("scene.xml")


NAN = float("nan")
REFUSED = [
    ("shadow_volume", [light([NAN, 0, 1])], {}, "light_0 is not finite"),
    ("shadow_map", [light([0, 0, 0])], {}, "light_0 is not finite"),
    ("shadow_volume", [{"type": "point", "position": [0, NAN, 1]}], {}, "light_0 is not finite"),
]


@pytest.mark.parametrize(("integrator", "lights", "shapes", "sentence"), REFUSED)
def test_what_cannot_be_right_is_one_sentence(integrator, lights, shapes, sentence):
    with pytest.raises(BrdfkitError, match=sentence):
        picture(scene(lights, **shapes), integrator)


def test_a_corner_nowhere_is_one_sentence():
    sail = triangle([-1, -1, 2], [1, -1, 2], [NAN, 0, 0])
    with pytest.raises(BrdfkitError, match="corners are not all finite"):
        picture(scene([light("point")], sail=sail), "shadow_volume")


def test_another_integrator_cannot_ask_for_single_rays():
    inner = {"type": "shadow_map"}
    with pytest.raises(BrdfkitError, match="shadow_map finds the shadows of a whole picture"):
        mi.load_dict({"type": "moment", "inner": inner}).render(scene([light("point")]), spp=1)


def test_ctrl_c_works_after_a_picture():
    """Mitsuba left its own handler behind, which ended the process."""
    picture(scene([light("point")]), "shadow_map")
    with pytest.raises(KeyboardInterrupt):
        os.kill(os.getpid(), signal.SIGINT)


# Compared


def compare(of, **how):
    usual = {"projections": "focused", "filters": "depth", "resolution": 64, "size": (24, 24)}
    return bk.shadows.compare(of, **(usual | how))


def test_ctrl_c_within_a_look_up_keeps_what_is_finished(monkeypatch):
    """There Dr.Jit raises its own error in place of KeyboardInterrupt."""
    finished, lit = [], ShadowMap.visibility

    def interrupted(*arguments):
        if finished[-1] == 1:
            raise KeyboardInterrupt
        return lit(*arguments)

    monkeypatch.setattr(ShadowMap, "visibility", interrupted)
    of, how = scene([light("point")]), {"projections": ["focused", "uniform"]}
    found = compare(of, **how, progress=lambda done, total: finished.append(done))
    assert [*found.scores] == ["focused"]
    assert found.interrupted


def test_only_where_a_spot_shines_a_shadow_can_be_wrong():
    """Of a narrow spot whose maps are fine; outside of its cone there is no light to be wrong."""
    of = scene([spot([-4, 2, 8], [0, 0, 0], 8)])
    scores = compare(of, resolution=1024).scores["focused"][0]
    assert scores.wrong < 0.02
    assert scores.acne < 0.02


def test_views_in_which_nothing_is_in_the_light_do_not_count(tmp_path):
    lit, others = light("directional"), {"others": "shadow_volume"}
    alone = compare(scene([lit]), **others)
    found = compare(scene([lit, spot(*AWAY, 20)], camera(), camera(target=(8, -12, 10))), **others)
    assert found.finished == found.requested == 8
    for label, its in alone.means.items():
        assert found.means[label].psnr == its.psnr
        assert found.means[label].wrong == its.wrong
    assert "In 3 of them nothing is in the light" in str(found)
    assert not found.relative
    found.write(tmp_path / "page.html")
    assert "nothing is in the light" in (tmp_path / "page.html").read_text(encoding="utf-8")


def test_a_black_picture_with_errors_has_no_decibels():
    found = compare(scene([light([0, 0, 1])]), resolution=8)
    assert found.scores["focused"][0].wrong > 0
    assert np.isnan(found.means["focused"].psnr)


def test_pixels_of_a_window_are_as_fine_as_they_are():
    """A window of half the side, in as many pixels as the whole: e is 4 times, 12 dB, as large."""
    whole, film = (
        [light("directional")],
        {f"crop_{name}": SIZE // 2 for name in ("width", "height")},
    )
    film |= {f"crop_offset_{axis}": SIZE // 4 for axis in "xy"}
    ground = {"ball": {"type": "sphere", "center": [0, 0, -9], "radius": 0.1}}
    narrow = camera(fov=1)  # in which the ground's texels are of one size
    same = {"resolution": 1024, "projections": "uniform"}
    coarse = compare(scene(whole, narrow, **ground), **same).means["uniform"].aliasing
    fine = compare(scene(whole, narrow | {"film": narrow["film"] | film}, **ground), **same)
    assert coarse - fine.means["uniform"].aliasing == pytest.approx(20 * np.log10(4), abs=0.2)


BAD = [
    ({"resolution": 0}, "resolution = 0 should be"),
    ({"resolution": "64"}, "resolution = '64' should be"),
    ({"resolution": 10**6}, "between 1 and 16384"),
    ({"size": 48}, r"size = 48 should be \(width, height\)"),
    ({"size": (0, 8)}, "the width in size = 0 should be"),
    ({"filters": 3}, "filters = 3 should be names"),
    ({"projections": []}, "no technique is asked for"),
]


@pytest.mark.parametrize(("how", "sentence"), BAD)
def test_a_bad_argument_is_one_sentence(how, sentence):
    with pytest.raises(BrdfkitError, match=sentence):
        compare(scene([light("point")]), **how)


def test_a_bad_scene_is_one_sentence():
    bare = {"type": "scene", "ball": {"type": "sphere"}}
    lens = {**camera(), "type": "orthographic"}
    lens.pop("fov")
    for of, sentence in (
        (bare, "not a scene; load it"),
        (mi.load_dict(bare), "no camera"),
        (scene([]), "no light"),
        (scene([{"type": "constant"}]), "no single place or direction"),
        (scene([light("point")], lens), "need a perspective one"),
        (scene([spot(*AWAY, 20)]), "no camera sees a surface that a light shines on"),
    ):
        with pytest.raises(BrdfkitError, match=sentence):
            compare(of)
