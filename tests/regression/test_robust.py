"""Robust least squares: MATLAB's figures, planted outliers, and the thesis's fits of CUReT."""

import drjit as dr
import numpy as np
import pytest
from robust_least_squares import robust_least_squares
from sample_sums import sample_sum

import brdfkit as bk
from brdfkit.checks.material_subject import draw_direction_pairs
from brdfkit.materials.measured.selection import select_samples
from brdfkit.model.evaluation import compute_lobe_values
from brdfkit.regression import losses
from brdfkit.regression.robust.reweighting import WEIGHTS

# y = 10 - 2x + e with the last one set to 0; MATLAB's robustfit (Kurt 2007, digest 6.5)
NOISE = [0.5377, 1.8339, -2.2588, 0.8622, 0.3188, -1.3077, -0.4336, 0.3426, 3.5784, 2.7694]
X = np.arange(1.0, 11.0)
Y = np.append((10 - 2 * X + NOISE)[:-1], 0.0)
DESIGN = np.stack([np.ones(10), X], axis=1)
MATLAB = {
    ("andrews", None): (8.4485, -1.5273),
    ("bisquare", None): (8.4505, -1.5278),
    ("bisquare", 3.0): (9.8618, -1.9040),
    ("bisquare", 6.0): (8.0878, -1.4293),
    ("cauchy", None): (8.5473, -1.5537),
    ("fair", None): (8.4600, -1.5279),
    ("huber", None): (8.4807, -1.5360),
    ("logistic", None): (8.5304, -1.5489),
    ("talwar", None): (7.8518, -1.3645),
}


@pytest.mark.quick
@pytest.mark.parametrize(("name", "tune"), MATLAB)
def test_coefficients_of_matlab(name, tune):
    found = robust_least_squares(DESIGN, Y, name, tune)
    np.testing.assert_allclose(found.solution, MATLAB[name, tune], atol=6e-5)
    assert found.converged


@pytest.mark.quick
def test_passes_of_matlab():
    found = robust_least_squares(DESIGN, Y)
    assert found.passes == 14
    assert found.weights[-1] == pytest.approx(0.534, abs=5e-4)
    welsch = robust_least_squares(DESIGN, Y, "welsch")
    assert (welsch.passes, welsch.converged) == (50, False)


@pytest.mark.quick
@pytest.mark.parametrize("name", WEIGHTS)
def test_no_weight_for_what_is_far(name):
    weight, _, rho = WEIGHTS[name]
    r = np.linspace(-4, 4, 801)
    assert weight(np.zeros(1)) == pytest.approx(1)
    np.testing.assert_allclose(weight(r), weight(-r))
    assert (np.diff(weight(r[r >= 0])) <= 1e-15).all()
    # rho is the integral of weight times r
    middle = (r[1:] + r[:-1]) / 2
    np.testing.assert_allclose(
        np.diff(rho(r)), weight(middle) * middle * 0.01, atol=2e-5 + 0.03 * (name == "talwar")
    )


@pytest.fixture(scope="module")
def spoiled():
    """A ggx material (grey), 1 % noise, every tenth sample five times too bright."""
    truth = bk.models()["ggx"](
        diffuse_reflectance=0.2, specular_reflectance=0.5, alpha_u=0.3, f0=0.1
    )
    wi, wo = draw_direction_pairs(3000, seed=5, max_degrees=79)
    values = truth.eval(wi, wo) * np.random.default_rng(6).normal(1, 0.01, (3000, 1))
    values[::10] *= 5
    return truth, bk.Measured.from_samples(wi, wo, values, channels=("Y",))


@pytest.mark.parametrize("loss", losses.named.by_sample)
def test_outliers_lose_their_say(spoiled, loss):
    truth, data = spoiled
    plain, robust = (bk.fit(data, "ggx", loss=loss, robust=r) for r in (None, "bisquare"))
    assert robust.loss > plain.loss  # which is of all samples
    assert robust.message.startswith("settled")
    wi, wo = draw_direction_pairs(1000, seed=7, max_degrees=75)
    off = [np.median(np.abs(f.eval(wi, wo) / truth.eval(wi, wo) - 1)) for f in (plain, robust)]
    assert off[1] < 0.01 < off[0]


@pytest.mark.parametrize(("name", "seed"), [("cauchy", 9), ("welsch", 9), ("logistic", 3)])
def test_few_samples_settle_where_matlabs_passes_do(name, seed):
    """Twelve samples of large leverage, which the merit of a pass knows."""
    wi, wo = draw_direction_pairs(12, seed=seed, max_degrees=79)
    values = np.random.default_rng(seed).standard_t(2, (12, 1)) + 3
    data = bk.Measured.from_samples(wi, wo, values, channels=("Y",))
    fit = bk.fit(data, "koenderink:order=2", loss=sample_sum("plain"), robust=name)
    columns, _ = compute_lobe_values(fit.model, wi, wo)
    found = robust_least_squares(columns, values[:, 0], name)
    assert found.converged
    weights = np.ravel([fit.values[n] for n in fit.model.weights()])
    np.testing.assert_allclose(weights, found.solution, rtol=1e-4, atol=1e-5)


@pytest.mark.quick
@pytest.mark.parametrize("name", WEIGHTS)
def test_no_weight_overflows(name):
    function, _, rho = WEIGHTS[name]
    with np.errstate(all="raise", under="ignore"):
        assert np.isfinite(function(np.array([0.0, 1e80, -1e200]))).all()
        assert np.isfinite(rho(np.array([0.0, 1e80]))).all()


def test_a_linear_fit_is_the_least_squares():
    """Without a search, `fit` and `robust_least_squares` are the same thing."""
    wi, wo = draw_direction_pairs(400, seed=8, max_degrees=79)
    values = np.random.default_rng(9).standard_t(2, (400, 1)) + 3
    data = bk.Measured.from_samples(wi, wo, values, channels=("Y",))
    for name in ("bisquare", "huber"):
        fit = bk.fit(data, "koenderink", loss=sample_sum("plain"), robust=name)
        samples = select_samples(data, 80.0)
        columns, _ = compute_lobe_values(fit.model, samples.wi, samples.wo)
        found = robust_least_squares(columns, values[:, 0], name)
        weights = [fit.values[n] for n in fit.model.weights()]
        np.testing.assert_allclose(np.ravel(weights), found.solution, rtol=1e-8)


def reweight_by_hand(design, values):
    """Solve for bisquare weights until nothing changes, without brdfkit's helpers."""
    q, r = np.linalg.qr(design)
    lever, skip = np.sqrt(1 - (q * q).sum(axis=1)), design.shape[1] - 1
    solution = q.T @ values
    for _ in range(500):
        off = np.abs(values - q @ solution) / lever
        ratio = off / (4.685 * np.median(np.sort(off)[skip:]) / 0.6745)
        weights = np.where(ratio < 1, (1 - ratio**2) ** 2, 0)
        before, solution = solution, np.linalg.solve(q.T * weights @ q, q.T @ (weights * values))
        if np.abs(solution - before).max() <= 1e-12 * np.abs(solution).max():
            break
    return np.linalg.solve(r, solution)


@pytest.mark.parametrize("label", ["pca_polynomial:degree=7", "koenderink:order=4"])
def test_linear_passes_run_no_kernels(label):
    """A robust fit ends where a few lines of NumPy do, and each pass is as cheap as there."""
    wi, wo = draw_direction_pairs(300, seed=8, max_degrees=79)
    noise = np.random.default_rng(4).standard_t(2, (300, 3)) / 20
    values = wi[:, 2:] * wo[:, 2:] + noise
    data = bk.Measured.from_samples(wi, wo, values)
    counts = {}
    with dr.scoped_set_flag(dr.JitFlag.KernelHistory):
        for robust in (None, "bisquare"):
            dr.kernel_history_clear()
            fit = bk.fit(data, label, loss=sample_sum("plain"), robust=robust)
            counts[robust] = len(dr.kernel_history([dr.KernelType.JIT]))
    assert fit.message.startswith("settled in ")
    passes = int(fit.message.split()[2])
    assert counts["bisquare"] - counts[None] <= 12 < passes
    columns, _ = compute_lobe_values(fit.model, wi, wo)
    weights = np.array([fit.values[n] for n in fit.model.weights()])
    for channel in range(3):
        by_hand = columns @ reweight_by_hand(columns, values[:, channel])
        np.testing.assert_allclose(columns @ weights[:, channel], by_hand, atol=1e-8)


def test_a_cycle_of_linear_passes_is_left(measured_data):
    """On CUReT's sample 45 the bisquare passes go round; Newton's steps end at the solution."""
    data = bk.load(measured_data / "curet" / "abrdf.dat#45")
    fit = bk.fit(data, "koenderink:order=2", loss=sample_sum("plain"), robust="bisquare")
    assert fit.message.startswith("settled")


def test_the_thesis_polynomial(measured_data):
    """Sample 12, rough paper, p = 7: the bisquare takes the highlight for outliers."""
    data = bk.load(measured_data / "curet" / "abrdf.dat#12")
    expected = {None: 0.011160, "bisquare": 0.0243}
    for robust, error in expected.items():
        fit = bk.fit(data, "pca_polynomial:degree=7", loss=sample_sum("plain"), robust=robust)
        samples = select_samples(data, 80.0)
        columns, _ = compute_lobe_values(fit.model, samples.wi, samples.wo)
        weights = np.ravel([fit.values[n] for n in fit.model.weights()])
        difference = (columns @ weights - samples.values[:, 0]) * samples.wi[:, 2]
        assert np.sqrt(losses.named["kurt"].importance(samples) @ difference**2) == pytest.approx(
            error, rel=3e-3
        )


def test_one_sample_of_cayman_makes_its_error(measured_data):
    """Kurt 2007, digest 22: whatever the degree, bisquare gives no weight to the one sample at
    θ_i 80°, θ_o 79°, φ 180°, whose residual makes E; without it E is 12 times smaller."""
    data = bk.load(measured_data / "cornell" / "cayman.brdf")
    wavelengths = np.array([float(name.removesuffix("nm")) for name in data.channels])
    blue, red = wavelengths < 500, wavelengths >= 600
    bands = [data.values[:, band].mean(axis=1) for band in (red, ~(blue | red), blue)]
    wi, wo, values = data.samples.wi, data.samples.wo, np.stack(bands, axis=1)
    data = bk.Measured.from_samples(wi, wo, values)
    others = np.arange(len(values)) != values.sum(axis=1).argmax()
    for degree in (1, 4):
        found = bk.fit(
            data, f"pca_polynomial:degree={degree}", loss="plain", robust="bisquare", max_angle=90
        )
        squares = (((found.eval(wi, wo) - values) * wi[:, 2:]) ** 2).sum(axis=1)
        assert np.sqrt(squares.mean()) == pytest.approx(4.9566, abs=5e-4)
        assert np.sqrt(squares[others].mean()) == pytest.approx(0.4094, abs=2e-3)


@pytest.mark.parametrize("robust", ["bisquare", "huber"])
@pytest.mark.parametrize(
    ("model", "samples", "parameters"), [("koenderink:order=8", 20, 55), ("ggx", 1, 4)]
)
def test_more_samples_than_parameters(model, samples, parameters, robust):
    """Else every sample is met: what is left tells of no scale."""
    wi, wo = draw_direction_pairs(samples, seed=1, max_degrees=79)
    data = bk.Measured.from_samples(wi, wo, np.full((samples, 1), 0.2), channels=("Y",))
    with pytest.raises(bk.BrdfkitError, match=f"here are {samples} and {parameters}:"):
        bk.fit(data, model, robust=robust)
    with pytest.raises(bk.BrdfkitError, match="here are 2 and 2:"):
        robust_least_squares(DESIGN[:2], Y[:2], robust)


def test_one_sample_more_than_parameters():
    wi, wo = draw_direction_pairs(15, seed=1, max_degrees=79)
    values = np.random.default_rng(2).uniform(0.1, 0.2, (15, 1))
    data = bk.Measured.from_samples(wi, wo, values, channels=("Y",))
    found = bk.fit(data, "koenderink:order=4", robust="bisquare")
    assert 0 < found.loss < 0.2


@pytest.mark.quick
def test_an_unknown_weight_is_said():
    with pytest.raises(bk.BrdfkitError, match=r"'tukey'; there are andrews, bisquare"):
        bk.fit(bk.load("dusty_gold"), "ggx", robust="tukey")
