"""Lesar (2018) reproduced: its parts at tiny sizes, values computed apart, and its verdicts."""

import gc
from contextlib import nullcontext

import numpy as np
import pytest

import brdfkit as bk
from brdfkit.core.jit import llvm

if llvm.find_loaded_version() < llvm.OLDEST:
    pytest.skip("needs LLVM", allow_module_level=True)

from brdfkit.theses.lesar2018 import (
    against_volpath,
    application,
    convergence,
    four_renderers,
    free_paths,
    half_floats,
    isosurface_depth,
    iteration_times,
    largest_values,
    phases,
    ray_marching,
    schlick,
    single_scattering,
    tone_mappers,
    transfer_functions,
)
from brdfkit.theses.lesar2018.iterations import make_cloud, make_renderer, make_stage

from brdfkit.theses.timing import compare_times
from brdfkit.volumes.rays import search


def verdicts(*parts, **settings):
    """The verdicts on the claims of some parts, in their order."""
    found = bk.reproduce("lesar2018", parts=list(parts), **settings)
    return [claim.verdict for claim in found.claims]


def change(monkeypatch, settings):
    """Set the constants of modules for a test."""
    for module, values in settings.items():
        for name, value in values.items():
            monkeypatch.setattr(module, name, value)


def test_phase_functions():
    """All densities, 35 values apart; a BSDF is none; Schlick's sign, and the range of its g."""
    yes, no = "confirmed", "not confirmed"
    assert verdicts("phase_functions") == [yes, yes, yes, no]
    assert verdicts("schlick") == [no, no, "not stated"]


def test_paths_and_places(monkeypatch):
    """T, mean place and look-ups by three majorants and by none; depths and largest values."""
    change(monkeypatch, {free_paths: {"RAYS": 1 << 16}, isosurface_depth: {"RAYS": 20_000}})
    change(monkeypatch, {largest_values: {"RAYS": 60, "ITERATIONS": 32, "DENSE": 2048}})
    found = verdicts("free_paths", "isosurface_depth", "largest_values")
    assert found == ["confirmed"] * 6
    found = isosurface_depth.measure_random_depth(10, np.random.default_rng(1))
    assert found == pytest.approx(0.0916, abs=0.002)


@pytest.mark.parametrize("steps", ray_marching.KNOWN)
def test_a_segment_that_does_not_dim_itself_is_of_first_order(steps):
    off = ray_marching.march_without_dimming(steps) - ray_marching.EXACT
    assert off == pytest.approx(ray_marching.KNOWN[steps][1], rel=0.01)


@pytest.mark.quick
def test_slabs_in_closed_form():
    known = [0.172314, 0.004882, 0.017146, 0.002585, 0.032698]
    found = [single_scattering.compute_closed_form(*slab) for slab in single_scattering.SLABS]
    np.testing.assert_allclose(found, known, atol=6e-7)


@pytest.mark.quick
@pytest.mark.parametrize(
    ("g", "k", "mean", "distance"),
    [(0.3, 0.45015, 0.31346, 0.0113), (0.9, 0.99405, 0.97108, 0.2103)],
)
def test_how_near_schlicks_is(g, k, mean, distance):
    assert schlick.compare_schlick(g) == pytest.approx((k, mean, distance), abs=6e-5)


@pytest.mark.quick
@pytest.mark.parametrize(
    ("name", "error", "largest"),
    [("Rayleigh", 0.023, 0.044), ("Mie hazy", 0.054, 0.17), ("Mie murky", 0.103, 0.67)],
)
def test_two_lobes_of_schlicks(name, error, largest):
    _, *found = phases.fit_two_lobes(*phases.TARGETS[name])
    assert found == pytest.approx((error, largest), abs=0.005)


def test_a_mean_in_16_bits_stops(monkeypatch):
    """At 0.0015, where 32 bits go on as 1/√n."""
    change(monkeypatch, {half_floats: {"PIXELS": 1024, "SHOWN": (100, 1000, 1500)}})
    assert verdicts("half_floats") == ["holds where the noise is 0 or 1, mean 0.1"]
    mean, draw = half_floats.NOISES["even, 0.45 to 0.55"]
    half, full = (
        half_floats.measure_errors(mean, draw, kind)[0][[999, -1]] for kind in ("f2", "f4")
    )
    assert half == pytest.approx([0.0015, 0.0015], rel=0.02)
    assert full == pytest.approx([0.00091, 0.00075], rel=0.05)


def test_pictures_where_no_scan_is_at_hand(monkeypatch, tmp_path):
    """Of the phantom alone; a page, and its pictures."""
    monkeypatch.delenv("BRDFKIT_DATA", raising=False)
    small = {"SIZE": 16, "FEWER": 4}
    change(
        monkeypatch,
        {
            four_renderers: small | {"SPP": {}},
            tone_mappers: small,
            transfer_functions: small | {"SPP": 1, "FRAME": 16},
        },
    )
    parts = "four_renderers", "transfer_functions", "tone_mappers"
    assert verdicts(*parts, path=tmp_path) == ["not run", "not stated", *["confirmed"] * 2]
    assert len(list(tmp_path.glob("*.png"))) == 3
    assert "Not at hand: MRI, frog." in (tmp_path / "lesar2018.md").read_text(encoding="utf-8")


def test_convergence_at_a_small_size(monkeypatch):
    """The slope, and equal curves."""
    change(monkeypatch, {convergence: {"ITERATIONS": {32: 100, 36: 20, 40: 20}, "VOXELS": 12}})
    change(monkeypatch, {convergence: {"SHOWN": (10, 30, 80)}})
    assert verdicts("convergence")[:3] == ["confirmed", "confirmed", "not stated"]


def test_nothing_is_freed_while_a_picture_is_recorded(llvm_variant, monkeypatch):
    """An abort of the process that cannot be caught, where garbage holds a scene of Mitsuba's."""
    mi, enabled = llvm_variant, []

    def draw(_scene, **_how):
        enabled.append(gc.isenabled())
        return mi.Float(1)

    monkeypatch.setattr(mi, "render", draw)
    make_renderer()(mi.load_dict({"type": "scene"}), 0)
    assert enabled == [False]
    assert gc.isenabled()


def test_the_end_of_a_run_as_its_reference():
    """Noise of a known variance: 0.13, 3.01 and 10 dB too large, and lower by another run."""
    rng, runs = np.random.default_rng(0), []
    for _ in range(2):
        means = np.cumsum(rng.normal(size=(1000, 5000)).astype("f4"), axis=0)
        kept = {n: means[n - 1] / n for n in (30, 500, 900, 1000)}
        runs.append(convergence.Run(kept[1000], np.ones(1), kept))
    for n, inflated in ((30, 0.13), (500, 3.01), (900, 10)):
        _, same, least, another, most = convergence.measure_psnr_excess(*runs, n)
        assert same == pytest.approx(least, abs=0.2)
        assert least == pytest.approx(inflated, abs=0.005)
        assert another == pytest.approx(most, abs=0.2)


@pytest.mark.quick
def test_times_beside_the_printed(monkeypatch):
    """As if each time were that of the phone; single scattering is the slowest."""

    def let_times_be(time):
        """Let iterations take times by their renderer, voxels and frame, equal in each turn."""
        monkeypatch.setattr(iteration_times, "prepare_iteration", time)

    def repeat(times, turns):
        return {label: np.full(turns, time) for label, time in times.items()}

    def phone(renderer, voxels, frame, steps=None):
        slow = {"single_scattering": 2, "maximum_intensity": 0.5}
        return slow.get(renderer, 1) * iteration_times.PRINTED["phone"][voxels, frame]

    monkeypatch.setattr(iteration_times, "measure_in_turns", repeat)
    let_times_be(phone)
    assert verdicts("iteration_times") == ["confirmed"] * 3 + ["not run", "not stated", "confirmed"]
    let_times_be(lambda renderer, voxels, frame, steps=None: frame**2 / len(renderer))
    assert verdicts("iteration_times")[:3] == ["not confirmed"] * 3
    # It would be the slowest with a search about the largest value, which the thesis does not have
    let_times_be(lambda name, *_: 1 + search.HALVINGS if name == "maximum_intensity" else 2)
    assert verdicts("iteration_times")[0] == "confirmed"


def test_a_plain_maximum_is_that_of_the_points(llvm_variant):
    found = []
    for searching in (nullcontext(), iteration_times.stop_refining()):
        with searching:
            scene = make_stage(make_cloud("maximum_intensity", 12) | {"steps": 4}, 16)
            found.append(np.array(llvm_variant.render(scene, spp=1, seed=0)))
    assert found[1].mean() < 0.99 * found[0].mean()


def test_the_application_at_a_small_size(monkeypatch):
    """By one renderer: its parts, its samples and its convergence; and a part that does nothing."""
    small = {"VOXELS": 12, "SIZE": 64, "REFERENCE": 20, "RENDERERS": ["single_scattering"]}
    change(monkeypatch, {application: small})
    ratio = compare_times([2.0, 2.0], [1.0, 1.0])
    monkeypatch.setattr(application, "measure_response", lambda *_: ratio)
    assert verdicts("application") == ["confirmed"] * 3 + ["not run"] * 2
    beside = {"show.slices": True}  # which the same samples are drawn with
    monkeypatch.setattr(application, "PARTS", {"camera": (beside, application.RENDERERS)})
    assert verdicts("application") == ["not confirmed"] * 2 + ["confirmed"] + ["not run"] * 2


@pytest.mark.quick
@pytest.mark.parametrize(("bias", "verdict"), [(0, "confirmed"), (0.1, "not confirmed")])
def test_a_bias_against_volpath_is_found(bias, verdict, monkeypatch):
    rng = np.random.default_rng(0)

    def pictures(scene, kind, spp, passes, first):
        mean = 1 + bias * (kind == "volpath")
        return mean + rng.normal(size=(passes, 16, 16, 3)), np.ones(passes)

    monkeypatch.setattr(against_volpath, "render_passes", pictures)
    assert verdicts("against_volpath")[0] == verdict


@pytest.mark.quick
def test_a_missing_package_is_asked_for_before_the_work(tmp_path, monkeypatch):
    (tmp_path / "measured").mkdir()
    (tmp_path / "volumes").mkdir()
    (tmp_path / "volumes" / "mni152_t1_1mm.nii.gz").write_bytes(b"")
    monkeypatch.setattr("brdfkit.theses.reproducing.find_spec", lambda name: None)
    monkeypatch.setattr("brdfkit.theses.lesar2018.PARTS", ())
    with pytest.raises(bk.BrdfkitError, match=r"needs the package nibabel; pip install .*volumes"):
        bk.reproduce("lesar2018", data=tmp_path / "measured")
