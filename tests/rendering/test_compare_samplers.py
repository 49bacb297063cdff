"""`compare_samplers`: its noise against a picture of many samples, and what it calls chance."""

import json

import numpy as np
import pytest
from click.testing import CliRunner

import brdfkit as bk
from brdfkit.cli import main
from brdfkit.rendering import map_sampling
from brdfkit.rendering.sampler_comparison import SamplerComparison


def comparison(rng, rounds=8, **costs):
    """Costs with 10 % of noise, and twice that which the samplers of a round share."""
    names = "envmap", "a", "b", "c"
    shared = rng.normal(0, 0.2, rounds)
    noise = {n: costs.get(n, 1) * np.exp(shared + rng.normal(0, 0.1, rounds)) for n in names}
    seconds = {n: np.full(rounds, 0.1) for n in names}
    return SamplerComparison("map", "plaster", "ball", noise, seconds, rounds)


def test_chance_is_called_significant_in_five_of_a_hundred():
    rng = np.random.default_rng(0)
    wrong = sum(
        any(found.significant(name) for name in found.noise)
        for found in (comparison(rng, 6) for _ in range(40))
    )
    assert wrong <= 6  # 2 are expected; 6 or fewer come with a probability of 0.997


@pytest.mark.quick
def test_what_costs_half_is_found_and_what_is_alike_is_said():
    found = comparison(np.random.default_rng(1), a=0.5, b=0.51, c=2)
    assert {name for name in found.noise if not found.significant(name)} == {"a", "b"}
    assert found.costs[found.best] == pytest.approx(0.5, rel=0.1)
    assert list(found.costs)[-1] == "c"
    assert "times what Mitsuba's envmap does" in found.verdict
    assert "may be as good" in found.verdict
    alike = comparison(np.random.default_rng(2), c=3)
    assert "c" not in alike.verdict.partition(";")[2]
    assert "may be as good" in alike.verdict or "may be chance" in alike.verdict


def use(monkeypatch, *names):
    """Compare only these samplers, which is quicker."""
    chosen = {name: map_sampling.SAMPLERS[name] for name in names}
    monkeypatch.setattr(map_sampling, "SAMPLERS", chosen)


def test_the_noise_is_the_distance_to_a_picture_of_many_samples(llvm_variant, monkeypatch):
    """Of samplers that differ, each of which comes to the same picture."""
    use(monkeypatch, "envmap", "alias")
    spp, size = 16, 16
    found = bk.rendering.compare_samplers(
        "studio", "plaster", scene="ball", rounds=8, spp=spp, size=size
    )
    scenes = map_sampling._load_scene_for_each_sampler("studio", bk.load("plaster"), "ball", size)
    truth = map_sampling._render_luminance(scenes["envmap"], 8192, 1000)
    scale = np.maximum(truth, map_sampling.DARK * truth.mean())
    for name, loaded in scenes.items():
        pictures = np.array(
            [map_sampling._render_luminance(loaded, spp, 500 + k) for k in range(16)]
        )
        distance = np.mean((pictures - truth) ** 2 / scale**2)
        assert found.noise[name].mean() == pytest.approx(distance, rel=0.2), name
        assert pictures.mean() == pytest.approx(truth.mean(), rel=0.01), name


def test_the_command_names_the_best_and_the_chance(monkeypatch):
    words = ["samplers", "studio", "--rounds", "3"]

    monkeypatch.setattr(
        map_sampling, "SAMPLERS", {n: map_sampling.SAMPLERS[n] for n in ("envmap", "blocks")}
    )
    run = CliRunner().invoke(main, [*words, "--json"])
    assert run.exit_code == 0, run.stderr
    printed = json.loads(run.stdout)
    assert set(printed["costs"]) == {"envmap", "blocks"}
    assert printed["best"] in printed["costs"]
    shown = CliRunner().invoke(main, words).stdout
    assert "best" in shown
    assert "Take " in shown or "which may be chance" in shown


@pytest.mark.quick
@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"rounds": 2}, "rounds = 2 should be a whole number, at least 3"),
        ({"environment": "nowhere.exr"}, "nowhere.exr"),
        ({"scene": "cornell_box"}, "lamps of its own"),
        ({"scene": 3}, "scene = 3 should be a scene's name or a mesh's file"),
    ],
)
def test_what_cannot_be_compared_is_said(llvm_variant, given, said):
    with pytest.raises(bk.BrdfkitError, match=said):
        bk.rendering.compare_samplers(**{"environment": "studio", "spp": 1, "size": 4, **given})
