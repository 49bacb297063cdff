"""`plan` and `complete`, and what a completed material keeps: files, channels, the command line."""

import io
import json
import pickle
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

import brdfkit as bk
from brdfkit.cli import main
from brdfkit.core.geometry.directions import from_angles, to_angles
from brdfkit.images.hatching import hatch
from brdfkit.materials.auditing.noise import estimate_noise
from brdfkit.materials.completion import plan_picture
from brdfkit.materials.completion.reach import Arms
from brdfkit.materials.measured import evidence
from brdfkit.materials.measured.measured_angles import MeasuredAngles
from brdfkit.reporting.verdict.verdict import describe_completion

angles = st.floats(10, 85)


@pytest.fixture(scope="module")
def chosen():
    return bk.plan(20)


@pytest.fixture(scope="module")
def truth():
    return bk.models()["ggx"](diffuse_reflectance=(0.3, 0.2, 0.1), alpha_u=0.2)


@pytest.fixture(scope="module")
def completed(chosen, truth):
    values = truth.eval(chosen.wi, chosen.wo)
    measured = bk.Measured.from_samples(chosen.wi, chosen.wo, values, name="twenty")
    return bk.complete(measured, noise=0.02)


@pytest.fixture
def cli(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return lambda *words: CliRunner().invoke(main, [str(word) for word in words])


# Plans


@settings(max_examples=20, deadline=None, derandomize=True)
@given(
    angles,
    angles,
    st.floats(0, 20),
    st.sampled_from([0.5, 1, 3, 7, 10]),
    st.booleans(),
    st.lists(st.floats(0, 80), max_size=3),
)
def test_a_plan_stays_within_the_reach(theta_i, theta_o, separation, step, in_plane, places):
    reach = {"max_theta_o": theta_o, "separation": separation, "step": step, "in_plane": in_plane}
    reach |= {"theta_i": places} if places else {"max_theta_i": theta_i}
    try:
        found = bk.plan(3, reach=reach)
    except bk.BrdfkitError:
        with pytest.raises(bk.BrdfkitError, match=r"reaches (no pair|[012] pairs) of directions"):
            bk.plan(3, reach=reach)
        return
    incidences, views, phi = found.angles.T
    assert incidences.max() <= (max(places) if places else theta_i) + 1e-8
    assert views.max() <= theta_o + 1e-8
    apart = np.degrees(np.arccos(np.clip(np.sum(found.wi * found.wo, axis=1), -1, 1)))
    assert apart.min() >= separation - 1e-5
    for column in [views] if places else [incidences, views]:
        assert np.allclose(column / step, np.round(column / step), atol=1e-7)
    assert not places or np.abs(incidences[:, None] - places).min(axis=1).max() < 1e-8
    beside = (180 - phi) / step
    assert np.isin(phi, (0, 180)).all() if in_plane else np.allclose(beside, beside.round())
    assert len(np.unique(found.angles, axis=0)) == 3


def test_directions_come_in_the_order_of_their_gain(chosen):
    assert len(chosen) == 20
    assert (np.diff(chosen.errors) < 0).all()
    gains = -np.diff(chosen.errors**2)
    assert (np.diff(gains) < 1e-9).all()
    assert (bk.plan(8).angles == chosen.angles[:8]).all()
    for fewer, more in chosen.halves:
        after = chosen.errors <= chosen.errors[fewer] / 2
        assert more == (np.flatnonzero(after)[0] if after.any() else None)


def test_angles_are_those_of_the_directions(chosen):
    (theta_i, phi_i), (theta_o, phi_o) = to_angles(chosen.wi), to_angles(chosen.wo)
    given_angles = np.degrees(np.stack([theta_i, theta_o, phi_o], axis=1))
    assert np.allclose(phi_i, 0)
    assert np.allclose(given_angles, chosen.angles, atol=1e-6)


def test_a_plan_repeats(chosen):
    assert (bk.plan(20).angles == chosen.angles).all()
    assert np.allclose(bk.plan(20).errors, chosen.errors, rtol=1e-12)
    assert not np.array_equal(bk.plan(20, seed=1).angles, chosen.angles)


def test_what_is_measured_is_not_proposed_again(chosen):
    measured = bk.Measured.from_samples(chosen.wi, chosen.wo, np.ones(20) * 0.1)
    more = bk.plan(5, measured=measured)
    assert more.errors[0] == pytest.approx(chosen.errors[-1])
    assert (more.errors < chosen.errors[-1] + 1e-12).all()
    together = {tuple(row) for row in chosen.angles} & {tuple(row) for row in more.angles}
    assert not together


def test_a_grid_has_every_pair_once():
    arms = Arms.from_reach({"step": 25, "separation": 0})
    found = arms.list_candidates(0)
    # Four angles each, and eight azimuths where neither is 0
    assert len(found) == 3 * 3 * 8 + 3 + 3 + 1
    assert len(np.unique(found, axis=0)) == len(found)


def test_a_plan_is_filled_in_and_read(chosen, truth, tmp_path):
    path = tmp_path / "plan.csv"
    chosen.save(path)
    with pytest.raises(bk.BrdfkitError, match=r"plan.csv: all fields of R, G, B are empty; fill"):
        bk.load(path)
    values = truth.eval(chosen.wi, chosen.wo)
    lines, filled = path.read_text(encoding="utf-8").splitlines(), 0
    for k, line in enumerate(lines):
        if line.endswith(",,,"):
            lines[k] = line.removesuffix(",,,") + "".join(
                f",{v!r}" for v in values[filled].tolist()
            )
            filled += 1
    lines[-1] = lines[-1][: lines[-1].index(",")] + ",0,40,20,,,"  # the last one was not measured
    path.write_text("\n".join(lines), encoding="utf-8")
    loaded = bk.load(path)
    assert np.allclose(loaded.samples.wi[:19], chosen.wi[:19])
    assert np.allclose(loaded.samples.wo[:19], chosen.wo[:19])
    assert np.array_equal(loaded.values[:19], values[:19])
    assert loaded.samples.valid.sum() == 19
    assert not loaded.anisotropic
    assert "comment" not in loaded.info  # the task is done
    assert bk.complete(loaded).evidence is not None


@pytest.mark.parametrize("channels", [("BRDF",), ("450nm", "550nm")])
def test_columns_of_values_have_the_channels(channels, tmp_path):
    bk.plan(2, reach={"step": 30}).save(tmp_path / "a.csv", channels)
    text = (tmp_path / "a.csv").read_text(encoding="utf-8")
    (tmp_path / "a.csv").write_text(
        text.replace("," * len(channels) + "\n", ",1" * len(channels) + "\n")
    )
    assert len(bk.load(tmp_path / "a.csv").channels) == len(channels)


def test_a_plan_is_shown(chosen, tmp_path):
    text = str(chosen)
    assert all(word in text for word in ("20 directions", "theta_o", "a factor of", "halves"))
    assert "<img" in chosen._repr_html_()
    chosen.save(tmp_path / "plan.svg")
    assert "<svg" in (tmp_path / "plan.svg").read_text(encoding="utf-8")


# Completed materials


def test_a_file_keeps_evidence(completed, tmp_path):
    bk.save(completed, tmp_path / "a.npz")
    loaded = bk.load(tmp_path / "a.npz")
    assert np.array_equal(loaded.evidence, completed.evidence)
    assert loaded.evidence.dtype == np.uint8
    assert np.array_equal(loaded.standard_error, completed.standard_error, equal_nan=True)
    assert loaded.info == completed.info


@pytest.mark.parametrize("wrong", [np.zeros(3, np.uint8), np.full(90 * 30 * 32, 7, np.uint8)])
def test_wrong_evidence_in_a_file_is_a_sentence(wrong, completed, tmp_path):
    bk.save(replace(completed, evidence=wrong), tmp_path / "a.npz")
    with pytest.raises(bk.BrdfkitError, match="evidence"):
        bk.load(tmp_path / "a.npz")


def test_an_older_file_has_no_evidence(completed, tmp_path):
    bk.save(replace(completed, evidence=None), tmp_path / "a.npz")
    assert bk.load(tmp_path / "a.npz").evidence is None


@pytest.mark.parametrize(
    "change",
    [
        lambda data: data.mix_channels(np.array([[0.2], [0.7], [0.1]]), ("Y",)),
        lambda data: data.rgb,
        lambda data: data.tabulated,
        lambda data: data.rendered,
        lambda data: replace(data, name="other"),
        lambda data: pickle.loads(pickle.dumps(data)),
    ],
    ids=["mixed", "rgb", "tabulated", "rendered", "replaced", "pickled"],
)
def test_other_forms_keep_evidence(change, completed):
    changed = change(completed)
    assert np.array_equal(changed.evidence, completed.evidence)
    assert changed.standard_error.shape == changed.values.shape


def test_shares_and_intervals_are_told(completed):
    shares = evidence.compute_shares(completed)
    assert sum(shares) == pytest.approx(1)
    assert shares[0] > 0
    assert shares[1] > shares[2]
    widths = evidence.compute_half_widths(completed)
    assert widths["inside"] < widths["at grazing angles"]
    assert "outside" not in widths  # from 80° on it is grazing, and between them is hardly anything


def test_formats_without_evidence_hold_the_values_and_say_so(completed, tmp_path):
    lost = bk.convert(completed, tmp_path / "a.binary").changes
    assert any(change.startswith("evidence measured") for change in lost)
    merl = bk.load(tmp_path / "a.binary")
    assert merl.evidence is None
    assert np.allclose(merl.values, completed.values, atol=1e-6, equal_nan=True)


def test_the_picture_of_a_plan_hides_no_mark_and_has_ticks(chosen):
    """Also where detectors share a place, and where all errors are nearly equal."""
    x, y = plan_picture.spread(np.full(4, -75.0), np.zeros(4))
    gaps = np.hypot(x[:, None] - x, y[:, None] - y) + 99 * np.eye(4)
    assert gaps.min() > 4
    assert (x[0], y[0]) == (-75, 0)
    assert (y >= 0).all()
    flat = bk.plan(3, measured=bk.Measured.from_samples(chosen.wi, chosen.wo, np.ones((20, 3))))
    assert len(flat.picture().axes[1].get_yticks()) > 1


# Commands


def test_the_commands(cli, truth):
    planned = cli("plan", 8, "--step", "5", "-o", "plan.csv", "--json")
    assert (planned.exit_code, planned.stderr) == (0, "")
    found = json.loads(planned.stdout)
    assert len(found["angles"]) == 8
    theta_i, theta_o, phi = np.array(found["angles"]).T
    wi, wo = (
        from_angles(np.radians(theta_i), 0.0),
        from_angles(np.radians(theta_o), np.radians(phi)),
    )
    bk.save(bk.Measured.from_samples(wi, wo, truth.eval(wi, wo)), "eight.csv")
    done = cli("complete", "eight.csv", "--noise", ".1", "-o", "full.npz")
    assert (done.exit_code, done.stderr) == (0, "")
    assert all(
        word in done.stdout for word in ("8 measured", "inferred", "grazing", "albedo", "75°")
    )
    full = bk.load("full.npz")
    assert full.evidence is not None
    assert full.standard_error is not None
    again = json.loads(cli("complete", "eight.csv", "--noise", ".1", "--json").stdout)
    assert again["completed"] == full.info["completed"]


def test_the_command_completes_wavelengths_that_give_no_colour(cli):
    infrared = tuple(f"{length}nm" for length in (1000, 1200, 1400, 1600))
    wi, wo = from_angles(np.radians([0, 20, 40, 60]), 0), from_angles(np.radians([60, 40, 9, 2]), 2)
    data = bk.Measured.from_samples(wi, wo, np.full((4, 4), 0.1), channels=infrared)
    bk.save(data, "infrared.csv")
    done = cli("complete", "infrared.csv", "-o", "full.npz")
    assert (done.exit_code, done.stderr) == (0, "")
    assert "(mean)" in done.stdout


TRAPS = [
    (["plan", "0"], "n = 0 should be a whole number"),
    (["plan", "x"], "'x' is not a valid integer"),
    (["plan", "9", "--step", "60"], "reach: step = 60.0 should be"),
    (["plan", "9", "--step", "1e-9"], "reach: step = 1e-09 should be a number between 0.001"),
    (["plan", "9", "--max-theta-i", "-5"], "reach: max_theta_i = -5.0 should be"),
    (["plan", "9", "--separation", "100"], "reach: separation = 100.0 should be"),
    (["plan", "9", "--max-theta-i", "9", "--max-theta-o", "9", "--separation", "30"], "no pair"),
    (["plan", "900", "--step", "30"], "fewer than 900; ask for fewer"),
    (["plan", "9", "--theta-i", "1,b"], "The angles '1,b' should read"),
    (["plan", "9", "--theta-i", "50", "--max-theta-i", "40"], "leave one of them out"),
    (["plan", "9", "--channels", "X", "-o", "a.csv"], "channels = X should be"),
    (["plan", "9", "--prior", "none.npz"], "none.npz"),
    (["plan", "9", "--measured", "none.csv"], "none.csv"),
    (["plan", "9", "--measured", "brushed_aluminium"], "anisotropic"),
    (["plan", "9", "-o", "a.txt"], "a.txt: a plan is written as .csv"),
    (["complete", "none.csv"], "none.csv"),
    (["complete", "empty.csv"], "empty.csv: all fields of R, G, B are empty"),
    (["complete", "red.csv"], "red.csv: all fields of G, B are empty; fill"),
    (["complete", "ggx"], "was not measured"),
    (["complete", "car_paint", "--noise", "7"], "noise = 7.0 should be"),
    (["complete", "few.csv"], "few has 3 values; measure at least 4"),
    (["complete", "few.csv", "-o", "no/a.npz"], "no/a.npz"),
]


@pytest.mark.parametrize(("words", "said"), TRAPS, ids=[" ".join(words) for words, _ in TRAPS])
def test_bad_input(cli, words, said):
    bk.plan(1, reach={"step": 30}).save("empty.csv")
    rows = Path("empty.csv").read_text(encoding="utf-8").replace(",,,", ",0.1,,")
    Path("red.csv").write_text(rows, encoding="utf-8")
    bk.save(bk.Measured.from_angles(30, 0, [10, 20, 30], 180, [0.1, 0.2, 0.3]), "few.csv")
    before = sorted(Path().iterdir())
    result = cli(*words)
    assert result.exit_code == 2, result.output
    assert result.stdout == ""
    assert result.stderr.count("\n") == 1
    assert said in result.stderr
    assert sorted(Path().iterdir()) == before


# Pictures


def test_lobes_have_a_band_and_three_lines(completed):
    figure = bk.plot([completed, "ggx"], theta_i=75)
    (legend,) = figure.legends
    labels = [text.get_text() for text in legend.get_texts()]
    assert labels[:2] == ["twenty", "ggx"]
    assert {"measured", "inferred", "guessed", "95 % interval"} < set(labels)
    few = bk.Measured.from_samples([[0, 0, 1.0]], [[0.6, 0, 0.8]], np.ones((1, 3)), name="twenty")
    (legend,) = bk.plot([few, completed], theta_i=75).legends
    assert [text.get_text() for text in legend.get_texts()][:2] == ["twenty", "twenty, completed"]
    styles = {str(line.get_linestyle()) for line in figure.axes[0].lines}
    assert len(styles) >= 2
    assert figure.axes[0].patches


def test_the_ball_of_a_completed_material_is_hatched(completed):
    hatched, plain = (
        Image.open(io.BytesIO(data.document().parts[0].draw()))
        for data in (completed, replace(completed, evidence=None))
    )
    differing = (np.asarray(hatched) != np.asarray(plain)).any(axis=-1)
    assert 0.05 < differing.mean() < 0.5


def test_sparse_and_dense_stripes_differ():
    levels = np.repeat([[0, 1, 2]], 60, axis=0).repeat(60, axis=1).astype(np.uint8)
    picture = np.full((60, 180, 3), 128, np.uint8)
    changed = (hatch(picture, levels) != 128).any(axis=-1)
    shares = [changed[:, 60 * k : 60 * k + 60].mean() for k in range(3)]
    assert shares[0] == 0
    assert 0 < shares[1] < shares[2] / 2


def test_repeated_directions_tell_noise_and_count_once(chosen, truth):
    """Three readings of each of 20 directions, with 10 % noise."""
    wi, wo = (np.repeat(w, 3, axis=0) for w in (chosen.wi, chosen.wo))
    values = truth.eval(wi, wo) * (1 + 0.1 * np.random.default_rng(0).normal(size=(60, 3)))
    thrice = bk.Measured.from_samples(wi, wo, values)
    noise = estimate_noise(thrice)
    assert noise.relative == pytest.approx((0.1,) * 3, rel=0.4)
    assert "measured twice" in noise.method
    few = bk.Measured.from_samples(wi[:9], wo[:9], values[:9])
    assert "fewer than 20 direction pairs were" in estimate_noise(few).method
    (said,) = bk.audit(thrice).findings()
    assert said.startswith("only 1.")
    assert "brdfkit complete" in said
    assert bk.plan(1, measured=thrice).info["measured"].startswith("20 directions")


def test_an_audit_tells_the_evidence(completed):
    rows = bk.audit(completed).rows()
    assert 75 <= bk.audit(completed).albedo.measured_to <= 80.5  # 5° beyond the plan's reach
    assert "inferred" in rows["evidence"]
    assert "grazing" in rows["95 % intervals"]
    assert not any("brdfkit complete" in said for said in bk.audit(completed).findings())
    (sentence,) = describe_completion(bk.audit(completed))
    assert rows["evidence"] in sentence
    assert "directions measured" in rows["coverage"]


def test_a_completed_material_is_not_completed_again(completed):
    with pytest.raises(bk.BrdfkitError, match="twenty is completed already, from 20 measured"):
        bk.complete(completed)
    with pytest.raises(bk.BrdfkitError, match="twenty is completed already"):
        bk.plan(3, measured=completed)


def test_a_view_hatches_by_evidence(completed):
    angles = MeasuredAngles(completed)
    theta = np.radians(np.arange(2.0, 89, 4))
    view = from_angles(theta, 0.0)
    kinds = angles.find_view_kinds(view[:, 2])
    assert (kinds[np.degrees(theta) < 60] == evidence.INFERRED).all()
    wi, wo = from_angles(0.5, 0.0), from_angles(0.6, 2.0)
    near = evidence.find_evidence(completed, wi[None], wo[None])
    assert angles.find_kinds(wi, wo) == near[0]


def test_a_rendering_repeats_a_completed_material_hatched(module_in_llvm, completed, tmp_path):
    from PIL import Image

    pictures = bk.render([completed, ("grey", "lambert")], spp=1, size=32)
    assert list(pictures.evidence) == ["twenty"]
    levels = pictures.evidence["twenty"]
    assert (levels[~pictures.mask] == 0).all()
    assert (levels[pictures.mask] >= evidence.INFERRED).mean() > 0.9
    pictures.write(tmp_path / "hatched.png")
    wide = np.asarray(Image.open(tmp_path / "hatched.png").convert("L"), float)
    tile = slice(-np.shape(wide)[1] // 3, None)  # the third of three
    first = wide[: wide.shape[0] // 2, : wide.shape[1] // 3]
    assert np.abs(np.diff(wide[: wide.shape[0] // 2, tile])).mean() > np.abs(np.diff(first)).mean()
    assert list(bk.preview(completed, size=16).evidence) == ["twenty"]
