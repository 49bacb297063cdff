"""`bk.shadows.compare`: scores that are known, of techniques and of the thesis."""

import json

import numpy as np
import pytest
from shadow_scenes import objects_on_a_ground

import brdfkit as bk
from brdfkit.shadows.aliasing_error import aliasing_error
from brdfkit.shadows.scores import Scores, between_lights, mean
from brdfkit.shadows.texture_use import share_used

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
    assert mean(cells).aliasing == pytest.approx(27.05375)
    assert between_lights(cells).aliasing == pytest.approx(2.0375)


def test_the_share_of_a_map_that_is_used():
    rng = np.random.default_rng(3)
    a_quarter = rng.random((100_000, 2)) / 2
    assert share_used([a_quarter]) == pytest.approx(0.25, rel=0.02)
    assert share_used([a_quarter, a_quarter + 0.5]) == pytest.approx(0.25, rel=0.02)
    assert share_used([a_quarter, a_quarter + 2]) == pytest.approx(0.125, rel=0.02)
    assert np.isnan(share_used([a_quarter + 2]))


def test_a_texel_of_one_pixel_is_48_decibels():
    assert aliasing_error(np.ones(5)) == pytest.approx(20 * np.log10(255))


@pytest.mark.usefixtures("llvm_variant")
def test_more_texels_are_better_and_a_map_that_ignores_the_camera_does_not_flicker():
    scene = objects_on_a_ground("directional")
    projections = "uniform", "focused"
    coarse, fine = (
        bk.shadows.compare(scene, projections, ["depth"], resolution=n, size=(64, 64)).means
        for n in (32, 512)
    )
    for name in projections:
        assert fine[name].psnr > coarse[name].psnr + 6
        assert fine[name].wrong < coarse[name].wrong / 3
        # a 16th of the length: e falls to 1/256, but for what it was cut at
        assert fine[name].aliasing > coarse[name].aliasing + 20
    assert coarse["uniform"].flicker == 0 < coarse["focused"].flicker


def test_the_command(tmp_path, capsys):
    from brdfkit.cli import main

    file = tmp_path / "scene.xml"
    file.write_text(SCENE)
    words = ["shadows", str(file), "--projection", "focused", "--filter", "depth"]
    sizes = ["--map", "64", "--size", "32"]
    main([*words, *sizes, "--json"], standalone_mode=False)
    printed = json.loads(capsys.readouterr().out)
    assert printed["lights"] == 1
    assert printed["scores"]["focused"][0]["psnr"] > 10
    with pytest.raises(bk.BrdfkitError, match="did you mean focused"):
        bk.shadows.compare(file, ["focussed"])
