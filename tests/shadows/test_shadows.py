"""`bk.shadows.compare`: scores that are known, of techniques and of the thesis."""

import io
import json
import re
from base64 import b64decode
from functools import partial
from types import SimpleNamespace

import mitsuba as mi
import numpy as np
import pytest
from PIL import Image
from shadow_scenes import LIGHTS, objects_on_a_ground, placement_of

import brdfkit as bk
from brdfkit.shadows.comparison.exact_shadow import LitView
from brdfkit.shadows.comparison.map_pictures import CHECKS, OUTSIDE, CompressedArray, MapPictures
from brdfkit.shadows.comparison.page import draw_errors
from brdfkit.shadows.comparison.quality import aliasing_error, share_of_texels_used
from brdfkit.shadows.comparison.scores import Scores, average_light_differences, average_scores
from brdfkit.shadows.comparison.tracked_points import (
    LIGHT_TURN,
    TrackedPoints,
    is_lit,
    make_light_path,
)
from brdfkit.shadows.maps.scenes import SCENES

SCENE = """<scene version="3.0.0">
    <integrator type="direct"/>
    <sensor type="perspective">
        <transform name="to_world"><lookat origin="0, -4, 3" target="0, 0, 0" up="0, 0, 1"/></transform>
        <film type="hdrfilm"><integer name="width" value="32"/><integer name="height" value="32"/></film>
    </sensor>
    <emitter type="directional"><vector name="direction" x="1" y="0" z="-1"/></emitter>
    <shape type="rectangle"/>
    <shape type="sphere"><point name="center" x="0" y="0" z="0.5"/><float name="radius" value="0.3"/></shape>
</scene>"""  # noqa: E501


def test_means_and_relative_scores_are_those_of_the_thesis():
    """Q2 of PSM: eight printed numbers, of which Table 1 has the mean and the relative score."""
    lights = [24.35, 24.83, 25.20, 31.83], [25.47, 24.76, 30.16, 29.83]
    cells = [Scores(aliasing=value) for view in zip(*lights, strict=True) for value in view]
    assert average_scores(cells).aliasing == pytest.approx(27.05375)
    assert average_light_differences(cells).aliasing == pytest.approx(2.0375)


def test_what_is_unknown_is_left_out_of_means():
    known = average_scores([Scores(psnr=10, acne=np.nan), Scores(psnr=np.inf, acne=0.5)])
    assert (known.psnr, known.acne) == ((10 + 99) / 2, 0.5)
    assert np.isnan(known.texture_use)
    cut_short = [Scores(psnr=10), Scores(psnr=13), Scores(psnr=50)]
    assert average_light_differences(cut_short).psnr == 3


def test_the_share_of_a_map_that_is_used():
    rng = np.random.default_rng(3)
    a_quarter = rng.random((100_000, 2)) / 2
    assert share_of_texels_used([a_quarter]) == pytest.approx(0.25, rel=0.02)
    assert share_of_texels_used([a_quarter, a_quarter + 0.5]) == pytest.approx(0.25, rel=0.02)
    assert share_of_texels_used([a_quarter, a_quarter + 2]) == pytest.approx(0.125, rel=0.02)
    assert np.isnan(share_of_texels_used([a_quarter + 2]))


def test_a_texel_of_one_pixel_is_48_decibels():
    assert aliasing_error(np.ones(5)) == pytest.approx(20 * np.log10(255))


@pytest.mark.usefixtures("llvm_variant")
def test_more_texels_are_better_and_a_map_that_ignores_the_camera_does_not_flicker():
    scene = objects_on_a_ground("directional")
    projections = "uniform", "focused"
    coarse, fine = (
        bk.shadows.compare(scene, projections, filters=["depth"], resolution=n, size=(64, 64)).means
        for n in (32, 512)
    )
    for name in projections:
        assert fine[name].psnr > coarse[name].psnr + 6
        assert fine[name].wrong < coarse[name].wrong / 3
        # a 16th of the length: e falls to 1/256, but for what it was cut at
        assert fine[name].aliasing > coarse[name].aliasing + 20
    assert coarse["uniform"].camera_flicker == 0 < coarse["focused"].camera_flicker
    for name in projections:
        assert 3 * fine[name].light_flicker < coarse[name].light_flicker


def seen_by_camera(scene, size=96):
    return LitView.from_sensor(scene, scene.sensors()[0], scene.emitters()[0], (size, size))


def with_light_of(kind, light):
    """The same scene by Mitsuba's light where a `Light` is."""
    if kind == "directional":
        return objects_on_a_ground((-light.point[:3]).tolist())
    scene = objects_on_a_ground(kind)
    parameters = mi.traverse(scene)
    parameters["light.position"] = light.point[:3].tolist()
    parameters.update()
    return scene


@pytest.mark.usefixtures("llvm_variant")
@pytest.mark.parametrize("kind", ["directional", "point"])
def test_a_moving_light_has_the_shadows_of_a_light_there_and_its_error_alone_flickers(kind):
    scene = objects_on_a_ground(kind)
    placement, seen = placement_of(scene), seen_by_camera(scene)
    tracked = TrackedPoints.by_moving_light(seen, placement)
    for each, true in zip(tracked.path, tracked.true, strict=True):
        there = seen_by_camera(with_light_of(kind, each.light)).exact[tracked.pixels]
        assert np.mean(true != there) < 0.002

    first = tracked.true[0]
    still = tracked.measure_flicker(
        seen.exact, lambda *_: SimpleNamespace(visibility=lambda p, n: first)
    )
    assert still == np.abs(np.diff(tracked.true.astype(float), axis=0)).mean() > 0.001

    def exact(seen, moved):
        return SimpleNamespace(visibility=partial(is_lit, seen.scene, moved.light))

    assert tracked.measure_flicker(seen.exact, exact) == 0


@pytest.mark.usefixtures("llvm_variant")
@pytest.mark.parametrize("kind", LIGHTS)
def test_what_is_farthest_from_a_moving_light_sees_it_turn_by_one_step(kind):
    placement = placement_of(objects_on_a_ground(kind))
    here, there = (each.light.point for each in make_light_path(placement)[:2])
    reach = 1 if kind == "directional" else placement.reach
    assert np.linalg.norm(there - here) / reach == pytest.approx(LIGHT_TURN, rel=0.01)


@pytest.mark.usefixtures("llvm_variant")
def test_a_scene_by_its_name_has_four_views_and_two_suns():
    how = {"filters": ["depth"], "resolution": 32, "size": (24, 16)}
    found = bk.shadows.compare("objects_on_a_ground", ["uniform"], **how)
    titles = [place.title for place in found.pictures]
    assert titles[0] == "View 1 (V1), light 1 (sun_1)"
    assert titles[-1] == "View 4 (V4), light 2 (sun_2)"
    assert found.requested == 8 == found.finished
    for number, view, light in ((0, "V1", 1), (5, "V3", 2)):
        alone = mi.load_dict(SCENES["objects_on_a_ground"](view, light, (24, 16)))
        seen = LitView.from_sensor(alone, alone.sensors()[0], alone.emitters()[0], (16, 24))
        assert np.array_equal(found.pictures[number].exact, seen.exact.reshape(16, 24))


@pytest.mark.parametrize(
    ("scene", "said"),
    [
        ("stret", "no file or scene 'stret'; did you mean street"),
        ("stret.xml", "stret.xml: there is no such file"),
        (3, "scene = 3 should be the path of a file, or one of"),
    ],
)
def test_a_wrong_scene_is_one_sentence(scene, said):
    with pytest.raises(bk.BrdfkitError, match=said):
        bk.shadows.compare(scene)


def compare_both(**more):
    """A map and both techniques without one, in one small picture."""
    others = "hybrid_shadow", "shadow_volume"
    how = {"filters": ["depth"], "others": others, "resolution": 32, "size": (48, 48)}
    return bk.shadows.compare(objects_on_a_ground("directional"), ["focused"], **how, **more)


@pytest.mark.usefixtures("llvm_variant")
def test_volumes_stand_beside_maps_and_a_page_has_the_pictures_of_all(tmp_path):
    found = compare_both()
    means = found.means
    assert found.best == "shadow_volume"
    assert means["shadow_volume"].wrong < 0.001 < 0.01 < means["focused"].wrong
    assert means["shadow_volume"].camera_flicker < 1e-4 < means["hybrid_shadow"].camera_flicker
    assert [row[4] == "–" for row in found.table()] == [name != "focused" for name in means]
    assert not found.relative
    assert not found.interrupted

    found.write(tmp_path / "page.html")
    page = (tmp_path / "page.html").read_text(encoding="utf-8")
    # exact and none; three techniques with their errors; a map with its depths; the scale's bar
    assert len(re.findall('<img src="data:image/', page)) == 2 + 2 * 3 + 2 + 1
    assert not re.search(r'(src|href)="(?!data:)', page)
    assert "View 1 (camera), light 1 (light)" in page
    with pytest.raises(bk.BrdfkitError, match=r"page\.txt: .* end it in \.html"):
        found.write(tmp_path / "page.txt")


@pytest.mark.usefixtures("llvm_variant")
def test_ctrl_c_keeps_the_techniques_that_are_finished():
    def stop_at(last):
        def progress(done, total):
            if done == last:
                raise KeyboardInterrupt

        return progress

    found = compare_both(progress=stop_at(2))
    assert [*found.scores] == ["focused", "hybrid_shadow"]
    assert found.interrupted
    assert "Interrupted: 2 of 3 scores" in str(found)
    with pytest.raises(KeyboardInterrupt):
        compare_both(progress=stop_at(0))


@pytest.mark.usefixtures("llvm_variant")
def test_the_checker_shows_how_wide_texels_are_and_the_light_sees_what_is_near_bright():
    """A ground of 8, all in the map, of which the camera sees 4 from above; a ball over it."""
    t, size = mi.ScalarTransform4f, 128
    above = t().look_at([0, 0, 20], [0, 0, 0], [0, 1, 0])
    scene = mi.load_dict(
        {
            "type": "scene",
            "light": {"type": "directional", "direction": [0, 0, -1]},
            "camera": {
                "type": "perspective",
                "fov": 2 * np.degrees(np.arctan(2 / 20)),
                "to_world": above,
                "film": {"type": "hdrfilm", "width": size, "height": size},
            },
            "ground": {"type": "rectangle", "to_world": t().scale(4)},
            "ball": {"type": "sphere", "center": [3, 3, 1], "radius": 0.5},
        }
    )
    seen = LitView.from_sensor(scene, scene.sensors()[0], scene.emitters()[0], (size, size))
    maps = MapPictures.from_view(seen, placement_of(scene), projection="uniform", resolution=64)
    assert not np.any(maps.part == OUTSIDE)
    shade = maps.shade
    for row in (shade[10], shade[:, 10]):
        changes = np.count_nonzero(np.abs(np.diff(row.astype(float))) > 0.2)
        assert abs(changes - CHECKS / 2) <= 1
    assert 0.003 < np.mean(maps.depths < 0.5) < 0.02  # of 64 the ball has 0.8


def test_errors_are_blue_where_light_is_lost_and_red_where_it_is_gained():
    address = draw_errors(np.array([[-1.0, 0.0, 1.0]]))
    data = b64decode(address.partition(",")[2])
    lost, right, gained = np.array(Image.open(io.BytesIO(data)).convert("RGB"), int)[0]
    assert lost[2] > lost[0] + 50
    assert gained[0] > gained[2] + 50
    assert np.ptp(right) < 5


def test_the_command(tmp_path, capsys):
    from brdfkit.cli import main

    file = tmp_path / "scene.xml"
    file.write_text(SCENE)
    page = tmp_path / "page.html"
    words = ["shadows", str(file), "--projection", "focused", "--filter", "depth", "-o", str(page)]
    sizes = ["--resolution", "64", "--size", "32"]
    main([*words, *sizes, "--json"], standalone_mode=False)
    printed = json.loads(capsys.readouterr().out)
    assert printed["lights"] == 1
    assert printed["scores"]["focused"][0]["psnr"] > 10
    assert printed["written"] == [str(page)]
    assert "focused" in page.read_text(encoding="utf-8")
    with pytest.raises(bk.BrdfkitError, match="did you mean focused"):
        bk.shadows.compare(file, ["focussed"])
    words[1] = "foliag"
    with pytest.raises(SystemExit) as ended:
        main([*words, "--force"])
    assert ended.value.code == 2
    assert "did you mean foliage" in capsys.readouterr().err
    with pytest.raises(bk.BrdfkitError, match="did you mean shadow_volume"):
        bk.shadows.compare(file, others=["shadow_volumes"])


def test_the_command_prints_a_line_for_each_technique_into_a_pipe(tmp_path, capsys, monkeypatch):
    from brdfkit.cli import main

    monkeypatch.delenv("COLUMNS", raising=False)
    file = tmp_path / "scene.xml"
    file.write_text(SCENE)
    words = ["--projection", "focused", "--projection", "uniform", "--filter", "depth"]
    main(
        ["shadows", str(file), *words, "--resolution", "32", "--size", "16"], standalone_mode=False
    )
    lines = capsys.readouterr().out.splitlines()
    for name in ("focused", "uniform"):
        (line,) = (line for line in lines if line.split()[:1] == [name])
        assert len(line.split()) > 8


@pytest.mark.quick
@pytest.mark.parametrize("kind", [bool, np.uint8, np.float16])
def test_packed_arrays_are_smaller_and_the_same(kind):
    array = (np.add.outer(np.arange(60), np.arange(80)) // 20).astype(kind)
    assert np.array_equal(CompressedArray.from_array(array).array, array)
    assert CompressedArray.from_array(array).array.dtype == kind
    assert len(CompressedArray.from_array(array).data) < array.nbytes / 10
