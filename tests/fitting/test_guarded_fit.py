"""Fits beyond the measured angles are guarded by a completed table of the material."""

import re
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

import brdfkit as bk
from brdfkit.cli import main
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.geometry.directions import from_angles
from brdfkit.fitting.guard import Guard
from brdfkit.images.ball import draw_pixels
from brdfkit.materials.auditing.highlight_sampling import (
    find_largest_ratio,
    warn_of_narrow_highlight,
)
from brdfkit.materials.measured.evidence import (
    MEASURED,
    compute_interval,
    evaluate_errors,
    find_evidence,
)
from brdfkit.materials.measured.selection import select_samples

MODELS = bk.models()
DULL = MODELS["ggx"](diffuse_reflectance=(0.3, 0.2, 0.1), alpha_u=0.3, f0=0.05)
STEEL = MODELS["student_t"](
    diffuse_reflectance=0.001, specular_reflectance=0.5, alpha_u=0.01, gamma=2.0, f0=0.5
)


def measure(truth, step=5, noise=0.0):
    """Measure a material as a goniometer with short arms does: to 60° and 75°."""
    axes = [0, 20, 40, 60], np.arange(0, 76, step), np.arange(0, 181, 20)
    theta_i, theta_o, phi = (np.radians(a).ravel() for a in np.meshgrid(*axes, indexing="ij"))
    wi, wo = from_angles(theta_i, 0 * theta_i), from_angles(theta_o, phi)
    factor = 1 + noise * np.random.default_rng(0).normal(size=(len(wi), 1))
    return bk.Measured.from_samples(wi, wo, truth.eval(wi, wo) * factor, name="partial")


def measure_psnr(truth, brdf):
    """Return the PSNR of a ball in a studio, up to 85°."""
    pixels = draw_pixels(("studio",), truth.eval, 85.0, 0, pixels=400, directions=32)
    apart = (pixels.evaluate(brdf.eval) - pixels.values) ** 2
    return -10 * np.log10(np.average(apart.mean(axis=1), weights=pixels.weights))


@pytest.fixture(scope="module")
def steel():
    return measure(STEEL)


@pytest.mark.parametrize("truth", [DULL, STEEL])
def test_a_fit_that_meets_the_samples_is_kept(truth):
    data = measure(truth)
    free, guarded = (bk.fit(data, type(truth), extrapolate=e) for e in ("free", "guarded"))
    assert free.values == guarded.values
    assert free.loss == guarded.loss
    assert free.certainty == guarded.certainty
    assert any("nothing tests it" in note for note in free.notes)


def test_a_limit_at_89_degrees_costs_no_light(measured_data):
    """Ward's albedo passes 1 near the horizon; a limit there would take a third of all light."""
    copper = bk.load(measured_data / "minidiff_paints" / "C10_Copper.astm.xz")
    free, guarded = (
        bk.fit(copper, "ward_duer", loss="log", extrapolate=e) for e in ("free", "guarded")
    )
    assert any("follows a table" in note for note in guarded.notes)
    light = [bk.albedo(fit.model, from_angles(0.1, 0.0)).mean() for fit in (free, guarded)]
    assert light[1] == pytest.approx(light[0], rel=0.1)


def test_a_fit_slightly_above_1_near_the_horizon_is_scaled(measured_data):
    black = bk.load(measured_data / "minidiff_paints" / "C2_Black.astm.xz")
    free, guarded = (bk.fit(black, "abc+student_t", extrapolate=e) for e in ("free", "guarded"))
    assert 1 < free.albedo.peak[1] < 1.1
    assert guarded.albedo.peak[1] <= 1.001
    assert any("the fit is scaled by 0.99" in note for note in guarded.notes)
    light = [bk.albedo(fit.model, from_angles(0.1, 0.0)).mean() for fit in (free, guarded)]
    assert light[1] == pytest.approx(light[0], rel=0.02)


def test_a_fit_that_runs_away_follows_the_table(steel, tmp_path):
    free, guarded = (bk.fit(steel, "torrance_sparrow", extrapolate=e) for e in ("free", "guarded"))
    assert free.albedo.peak[1] > 1.2
    assert guarded.albedo.peak[1] <= 1
    assert measure_psnr(STEEL, guarded) > measure_psnr(STEEL, free) + 10
    (note,) = [n for n in guarded.notes if n.startswith("beyond the measured angles")]
    assert "60° and 75°" in note
    assert "completed by the prior of brdfkit's models" in note
    assert 'extrapolate="free") it would reflect 1.4 of the light at 89°' in note.replace(
        "1.38", "1.4"
    )
    pattern = r"beyond 60° and 75° were not measured; there this fit reaches [\d.]+ times the l"
    assert [bool(re.search(pattern, " ".join(f.notes))) for f in (free, guarded)] == [True, False]
    # The loss is that of the measured samples
    loss = bk.compare(steel, guarded).errors[guarded.name]["cbrt"]
    assert guarded.loss == pytest.approx(loss, rel=1e-9)
    assert np.isnan(guarded.standard_errors["alpha"])
    with pytest.raises(BrdfkitError, match='fit with extrapolate="free" first'):
        bk.uncertainty.bootstrap(guarded, steel, draws=2)
    bk.save(guarded, tmp_path / "fit.json")
    again = bk.load(tmp_path / "fit.json")
    assert again == guarded
    assert again.settings["extrapolate"] == "guarded"


def test_full_tables_and_whole_hemispheres_are_not_guarded(steel):
    table = bk.Measured.from_table(
        DULL.eval(*(w.reshape(-1, 3) for w in directions())).reshape(SHAPE)
    )
    assert Guard.for_fit(table, 80.0) is None
    assert Guard.for_fit(steel, 60.0) is None
    fits = [bk.fit(table, "ggx", extrapolate=e) for e in ("free", "guarded")]
    assert fits[0].values == fits[1].values
    assert fits[0].notes == fits[1].notes


SHAPE = (30, 10, 12, 3)


def directions():
    """Return the directions of the cells of a small table."""
    from brdfkit.model.samples import Table

    wi, wo = Table(np.zeros(SHAPE)).directions()
    return np.where(wi[..., 2:] > 0, wi, (0, 0, 1)), np.where(wo[..., 2:] > 0, wo, (0, 0, 1))


@pytest.mark.parametrize(
    ("how", "why"),
    [
        ({"robust": "bisquare"}, "robust weights tell outliers from the samples alone"),
        ({"weights": 1.0}, "weights of samples do not apply to a table"),
        ({"anisotropic": True}, "the table is isotropic"),
    ],
)
def test_fits_that_are_not_guarded_say_why(how, why):
    data = measure(DULL)
    if "weights" in how:
        how = {"weights": np.ones(len(data.values))}
    assert bk.fit(data, "ward", **how).notes[-1].endswith(f"it is not guarded, because {why}")


def test_values_in_another_unit_are_not_guarded():
    data = measure(DULL)
    samples = data.samples
    large = bk.Measured.from_samples(samples.wi, samples.wo, 100 * samples.values)
    assert Guard.for_fit(data, 80.0) is not None
    assert Guard.for_fit(large, 80.0) is None


def test_an_unknown_extrapolation_is_refused():
    with pytest.raises(BrdfkitError, match="no extrapolation 'fre'"):
        bk.fit(measure(DULL), "lambert", extrapolate="fre")


def test_the_command_takes_the_option(tmp_path):
    bk.save(measure(DULL), tmp_path / "dull.csv")
    file = str(tmp_path / "dull.csv")
    words = ["fit", file, "-m", "lambert", "--extrapolate", "free", "-o", str(tmp_path)]
    assert CliRunner().invoke(main, words).exit_code == 0
    assert bk.load(tmp_path / "lambert.json").settings["extrapolate"] == "free"


@pytest.mark.parametrize("step", [1, 3, 5, 10])
def test_a_highlight_narrower_than_the_sampling_is_reported(step):
    """A highlight is narrow where half its width is less than half a step."""
    for alpha, is_narrow in ((0.004, True), (0.5, False)):
        truth = MODELS["ggx"](diffuse_reflectance=0.1, alpha_u=alpha, f0=0.05)
        data = measure(truth, step, noise=0.05)
        assert bool(warn_of_narrow_highlight(data)) == is_narrow
    found, ratio = find_largest_ratio(measure(STEEL, step).samples)
    assert found == pytest.approx(step)
    assert ratio > 3
    assert f"neighbours {step}° apart differ" in warn_of_narrow_highlight(measure(STEEL, step))


def test_intervals_of_predictions_hold_the_truth():
    """Near samples, and never narrower beyond the measured angles than the table's."""
    truth = MODELS["student_t"](diffuse_reflectance=0.2, alpha_u=0.2, gamma=2.0, f0=0.05)
    data = measure(truth, noise=0.05)
    fit = bk.fit(data, "ggx", extrapolate="free")
    rng = np.random.default_rng(0)
    theta, phi = np.arccos(rng.uniform(0.2, 1, (2, 400))), rng.uniform(0, np.pi, 400)
    wi, wo = from_angles(theta[0], 0 * phi), from_angles(theta[1], phi)
    found = bk.uncertainty.predict(fit, data, wi=wi, wo=wo)
    np.testing.assert_allclose(found.values, fit.eval(wi, wo), rtol=1e-12)
    assert (found.low <= found.values).all()
    assert (found.values <= found.high).all()
    true = truth.eval(wi, wo)
    covers = ((found.low <= true) & (true <= found.high)).all(axis=1)
    assert covers[found.near].mean() > 0.9
    assert covers[~found.near].mean() > 0.9
    widths = np.log(found.high / found.low).mean(axis=1)
    assert np.median(widths[~found.near]) > np.median(widths[found.near])
    with pytest.raises(BrdfkitError, match=r"both \(n, 3\)"):
        bk.uncertainty.predict(fit, data, wi=wi, wo=wo[:5])


@pytest.fixture(scope="module")
def completed(steel):
    return bk.complete(steel)


def test_a_fit_to_a_completed_table_claims_no_more_than_the_table(completed):
    """Its cells are no measurements: no standard errors, and intervals as wide as the table's."""
    fit = bk.fit(completed, "ward")
    assert not fit.certainty.names
    made = "fitted to a completed table, from 640 measured values"
    assert any(note.startswith(made) for note in fit.notes)
    with pytest.raises(BrdfkitError, match="no cell was measured alone; fit the measured values"):
        bk.uncertainty.bootstrap(fit, completed)
    theta = np.radians([30.0, 70.0])
    wi, wo = from_angles(theta, 0 * theta), from_angles(theta * 0.9, [np.pi, 1.0])
    found = bk.uncertainty.predict(fit, completed, wi=wi, wo=wo)
    assert found.near.tolist() == (find_evidence(completed, wi, wo) == MEASURED).tolist()
    assert not found.near.all()
    light = (wi[:, 2] * wo[:, 2])[:, None]
    low, high = compute_interval(completed.eval(wi, wo), evaluate_errors(completed, wi, wo), light)
    assert (found.low <= 1.01 * low).all()
    assert (found.high >= 0.99 * high).all()


def test_cells_of_a_completed_table_count_by_their_certainty(completed):
    cells, plain = (select_samples(completed, 80.0, errors=errors) for errors in (True, False))
    assert cells.errors is None
    assert (plain.weight == 1).all()
    places = completed.table.find_cells(cells.wi, cells.wo)
    evidence = completed.evidence.reshape(completed.table.shape)[places]
    measured, inferred, guessed = (cells.weight[evidence == kind].mean() for kind in range(3))
    assert 1 > measured > inferred > guessed > 0
    # Guesses have intervals of more than a factor of 2: deviations above ln 2 / 1.96
    assert guessed < 1 / (1 + (np.log(2) / 1.96 / 0.2) ** 2)


def test_a_prediction_stays_within_the_bounds_of_uncertain_parameters():
    """The standard error of f0, which is on its bound, is far larger than its range."""
    data = measure(DULL)
    fit = bk.fit(data, "ggx", extrapolate="free")
    spread = np.diag(np.where(np.array(fit.certainty.names) == "f0", 1e6, 0.0))
    model = type(fit.model)(**{**fit.model.free_values, "f0": 1.0})
    certainty = replace(fit.certainty, covariance=tuple(map(tuple, spread)))
    fit = replace(fit, model=model, certainty=certainty)
    wi = wo = from_angles(np.radians([0.0, 30.0]), np.zeros(2))
    assert np.isfinite(bk.uncertainty.predict(fit, data, wi=wi, wo=wo).low).all()


@pytest.mark.parametrize(
    ("wi", "said"),
    [
        (np.full((2, 3), np.nan), "is not finite, or not above"),
        ([[0, 0, -1], [0, 0, 1]], "is not finite, or not above"),
        (np.empty((0, 3)), r"both \(n, 3\)"),
        ("up", "wi: they should be numbers"),
    ],
)
def test_wrong_directions_of_a_prediction_are_a_sentence(wi, said):
    data = measure(DULL)
    with pytest.raises(BrdfkitError, match=said):
        bk.uncertainty.predict(bk.fit(data, "lambert"), data, wi=wi, wo=wi)
