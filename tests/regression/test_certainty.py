"""Standard errors and intervals: right where it can be counted, and none where nothing is known."""

import json
import pickle

import numpy as np
import pytest
from coverage_of_intervals import held
from measured_models import noisy
from sample_sums import sample_sum
from scipy.stats import binom

import brdfkit as bk
from brdfkit.checks.material_subject import draw_direction_pairs
from brdfkit.core.geometry.directions import from_angles
from brdfkit.materials.measured.selection import select_samples
from brdfkit.model import labels
from brdfkit.model.evaluation import compute_lobe_values
from brdfkit.regression import certainty, losses
from brdfkit.regression.problem.parameter_space import Space
from brdfkit.regression.problem.problem import Problem

UP = [[0.0, 0.0, 1.0]]


def significantly_few(inside, level=1e-4):
    """Which columns of `inside` (replicates, parameters) hold less often than 95 %, by chance with
    a probability below `level`."""
    known = np.isfinite(inside).sum(axis=0)
    return np.nansum(inside, axis=0) < binom.ppf(level, known, 0.95)


@pytest.mark.parametrize(
    ("model", "loss", "noise"),
    [
        ("ggx", "log", "multiplied"),
        ("ward", "cosine", "added"),
        ("cook_torrance", "cbrt", "even"),
        ("koenderink", "plain", "multiplied"),
    ],
)
def test_intervals_hold_the_truth(model, loss, noise):
    """In 90 to 99 % of 80 tables, all parameters together: 95 % but for chance at a level of 1e-4,
    as parameters and channels are nearly independent. The proof with 400: the program."""
    inside, _ = held(model, loss, noise, 80)
    assert 0.90 < np.nanmean(inside) < 0.99
    assert not significantly_few(inside).any()


def test_intervals_of_a_robust_fit_hold_the_truth():
    inside, _ = held("lambert", "log", "even", 30, n=100, robust="huber")
    assert 0.90 < np.nanmean(inside) < 0.99
    assert not significantly_few(inside).any()


@pytest.mark.quick
def test_a_linear_model_has_the_sandwich_of_the_textbook():
    wi, wo = draw_direction_pairs(100, seed=1, max_degrees=79)
    rng = np.random.default_rng(2)
    values = 0.1 + 0.05 * wi[:, 2:] + 0.02 * wo[:, 2:] * rng.normal(size=(100, 1))
    data = bk.Measured.from_samples(wi, wo, values, channels=("Y",))
    fit = bk.fit(data, "koenderink", loss=sample_sum("plain"))
    J, _ = compute_lobe_values(fit.model, wi, wo)
    J = J.T if len(J) == len(fit.values) else J
    inverse = np.linalg.inv(J.T @ J)
    solution = np.linalg.lstsq(J, values[:, 0], rcond=None)[0]
    residuals = values[:, 0] - J @ solution
    lever = np.einsum("ni,ij,nj->n", J, inverse, J)
    scores = J * (residuals / np.sqrt(1 - lever))[:, None]
    np.testing.assert_allclose(fit.covariance, inverse @ scores.T @ scores @ inverse, rtol=1e-6)
    errors = np.ravel(list(fit.standard_errors.values()))
    np.testing.assert_allclose(errors, np.sqrt(np.diagonal(fit.covariance)))
    assert fit.degrees_of_freedom == 100 - len(solution)
    deviance = 100 * np.log(np.mean(residuals**2))
    assert fit.aic == pytest.approx(deviance + 2 * len(solution))
    assert fit.bic == pytest.approx(deviance + len(solution) * np.log(100))


@pytest.mark.quick
def test_intervals_are_around_the_values_and_printed():
    fit = bk.fit(noisy(bk.models()["ggx"](diffuse_reflectance=(0.1, 0.2, 0.3))), "ggx")
    assert fit.standard_errors["alpha_v"] == fit.standard_errors["alpha_u"] > 0
    for name, value in fit.values.items():
        pairs = np.reshape(fit.intervals[name], (-1, 2))
        np.testing.assert_allclose(pairs.mean(axis=1), np.atleast_1d(value))
        half = 1.96 * np.atleast_1d(fit.standard_errors[name])
        assert (np.diff(pairs)[:, 0] / 2 > half).all()
    assert str(fit).count(" ± ") == 1 + 1 + 1 + 3 + 3
    assert "f0" in fit.certainty.names
    np.testing.assert_allclose(np.diagonal(fit.correlation), 1)


@pytest.mark.quick
@pytest.mark.parametrize(("seed", "f0"), [(0, 0.5), (2, 0.8), (3, 0.2)])
def test_what_trades_off_is_said(seed, f0):
    """Directions near the normal determine only the product of strength and Fresnel reflectance.

    The search ends anywhere along this product, for some seeds on the bound f0 = 1.
    """
    rng = np.random.default_rng(seed)
    wi, wo = (from_angles(rng.uniform(0, 0.3, 300), rng.uniform(0, 6, 300)) for _ in range(2))
    values = bk.models()["cook_torrance"](f0=f0).eval(wi, wo)
    values *= np.exp(1e-5 * rng.normal(size=values.shape))
    data = bk.Measured.from_samples(wi, wo, values, channels=("Y",))
    fit = bk.fit(data, "cook_torrance", loss="log", starts=1)
    (said,) = [note for note in fit.notes if "f0" in note and "trade off" in note]
    assert "specular_reflectance" in said
    assert "only their product is determined" in said
    assert np.isnan(fit.standard_errors["f0"])
    assert np.isnan(fit.standard_errors["specular_reflectance"]).all()


@pytest.mark.quick
def test_few_samples_for_many_weights_do_not_trade_off():
    """A sandwich of fewer samples than parameters is singular; what was measured is not."""
    data = noisy(bk.models()["ggx"](diffuse_reflectance=(1, 2, 3)), 16)
    fit = bk.fit(data, "koenderink", loss="plain")
    assert fit.samples < len(fit.certainty.names)
    assert not any("trade off" in note for note in fit.notes)


@pytest.mark.quick
def test_what_is_not_determined_is_said():
    """Of Lafortune's lobe the lengths, of a hundred equal directions all but one number."""
    fit = bk.fit(noisy(bk.models()["lafortune"]()), "lafortune", starts=1)
    assert any(
        note == "c_x and c_z trade off: only their ratio is determined" for note in fit.notes
    )
    assert np.isnan(fit.standard_errors["c_z"])
    assert fit.standard_errors["exponent"] > 0
    values = 0.2 + 0.01 * np.random.default_rng(0).normal(size=(100, 1))
    same = bk.Measured.from_samples(UP * 100, UP * 100, values, channels=("Y",))
    fit = bk.fit(same, "ward")
    assert "converged" not in fit.message
    assert np.isnan(fit.standard_errors["alpha_u"])
    assert any("trade off: only a combination" in note for note in fit.notes)


@pytest.mark.quick
@pytest.mark.parametrize(("model", "said"), [("ward", "underdetermined"), ("lambert", "as many")])
def test_one_sample_does_not_converge(model, said):
    fit = bk.fit(bk.Measured.from_samples(UP, UP, [[0.2, 0.3, 0.4]]), model)
    assert fit.message.startswith(said)
    assert "converged" not in str(fit)
    assert all(np.isnan(error).all() for error in map(np.array, fit.standard_errors.values()))
    assert np.isnan(fit.intervals["diffuse_reflectance"]).all()


@pytest.mark.quick
def test_on_a_bound_is_no_interval():
    data = noisy(bk.models()["ward"](alpha_u=0.4))
    fit = bk.fit(data, "ward", bounds={"alpha_u": (0.01, 0.3)})
    assert np.isnan(fit.standard_errors["alpha_u"])
    assert fit.standard_errors["diffuse_reflectance"][0] > 0
    fit = bk.fit(data, "ward", fixed={"alpha_u": 0.4})
    assert np.isnan(fit.intervals["alpha_u"]).all()
    assert fit.degrees_of_freedom == fit.samples - 2


def test_a_saved_or_pickled_fit_is_equal(tmp_path):
    data = noisy(bk.models()["ggx"](diffuse_reflectance=(0.1, 0.2, 0.3)))
    one = bk.Measured.from_samples(UP, UP, [[0.2, 0.3, 0.4]])
    for fit in (
        bk.fit(data, "ggx", bounds={"alpha_u": (0.05, 0.5)}, fixed={"f0": 0.04}),
        bk.fit(data, "ggx", loss="cosine", robust="huber", starts=1),
        bk.fit(data, "lafortune", starts=1),
        bk.fit(one, "ward"),
    ):
        bk.save(fit, tmp_path / "fit.json")
        assert bk.load(tmp_path / "fit.json") == fit
        assert pickle.loads(pickle.dumps(fit)) == fit


@pytest.mark.quick
def test_a_fit_of_an_earlier_version_is_read(tmp_path):
    file = tmp_path / "fit.json"
    fit = bk.fit(noisy(bk.models()["ward"]()), "ward", starts=1)
    bk.save(fit, file)
    record = json.loads(file.read_text())
    del record["fit"]["certainty"]
    file.write_text(json.dumps(record))
    old = bk.load(file)
    assert old.values == fit.values
    assert old.degrees_of_freedom is None
    assert np.isnan([old.aic, old.bic, old.standard_errors["alpha_u"]]).all()
    assert "±" not in str(old)


@pytest.mark.parametrize("loss", ["log", "plain"])
def test_a_part_is_as_certain_as_the_whole(loss, monkeypatch):
    """Standard errors of 20,000 samples by a sixth of them, to a tenth."""
    data = noisy(bk.models()["ggx"](diffuse_reflectance=(0.1, 0.2, 0.3)), n=20_000)
    model, samples = labels.model("ggx"), select_samples(data, 80.0)
    problem = Problem(model, samples, losses.named[loss], Space.for_model(model, {}, {}, False))
    fit = bk.fit(data, "ggx", loss=loss, starts=1)
    u = problem.space.to_coordinates(fit.values)[None]
    weights = np.array([fit.values[n] for n in model.weights()]).T[None]
    whole = certainty.compute_certainty(problem, u, weights)
    monkeypatch.setattr(certainty, "MANY_SAMPLES", 6000)
    part = certainty.compute_certainty(problem, u, weights, rng=np.random.default_rng(0))
    assert part.names == whole.names
    ratio = [
        part.compute_standard_errors()[n] / e for n, e in whole.compute_standard_errors().items()
    ]
    np.testing.assert_allclose(ratio, 1, atol=0.1)
