"""Kurt 2007, eqs. 7.8 and 7.10: the error of a linear model's prediction, beside a simulation."""

import numpy as np
import pytest
from measured_models import synthetic

import brdfkit as bk
from brdfkit.core.errors import BrdfkitError
from brdfkit.model.evaluation import compute_lobe_values


@pytest.mark.parametrize(("name", "loss"), [("koenderink", "plain"), ("pca_polynomial", "cosine")])
def test_variance_and_bias_are_those_of_repeated_fits(name, loss):
    """Fits of 100 noisy measurements of a GGX, which these models cannot follow."""
    truth, sigma, count = bk.models()["ggx"](alpha_u=0.4), 0.05, 100
    clean = synthetic(truth, n=120)
    wi, wo = clean.samples.wi, clean.samples.wo
    noise = sigma * np.random.default_rng(3).normal(size=(count, len(wi), 1))
    measured = [bk.Measured.from_samples(wi, wo, clean.values + e, channels=("Y",)) for e in noise]
    fits = [bk.fit(data, name, loss=loss) for data in measured]
    error = bk.uncertainty.prediction_error(fits[0], measured[0], truth=truth, sigma=sigma)
    rows = measured[0].samples.within(80)
    lobes = np.array([np.ravel([f.values[n] for n in f.model.weights()]) for f in fits])
    predicted = compute_lobe_values(fits[0].model, wi[rows], wo[rows])[0] @ lobes.T
    known = truth.eval(wi[rows], wo[rows])
    np.testing.assert_allclose(
        error.bias, predicted.mean(axis=1, keepdims=True) - known, atol=5 * sigma / count**0.5
    )
    assert np.sqrt(np.mean(error.bias**2)) > 5 * sigma / count**0.5
    ratio = predicted.var(axis=1, ddof=1) / error.variance[:, 0]
    assert np.mean(ratio) == pytest.approx(1, abs=0.15)
    mean_square = ((predicted - known) ** 2).mean(axis=1)
    assert np.mean(error.mean_square) == pytest.approx(mean_square.mean(), rel=0.05)


def test_of_the_measured_values_it_is_the_residuals():
    data = synthetic(bk.models()["ggx"](diffuse_reflectance=(0.1, 0.2, 0.3), alpha_u=0.4), n=120)
    fit = bk.fit(data, "pca_polynomial", loss="plain")
    left = fit.residuals(data)
    error = bk.uncertainty.prediction_error(fit, data)
    lobes = -left.values[left.samples.valid]
    unclamped = fit.eval(*(w[left.samples.valid] for w in (data.samples.wi, data.samples.wo))) > 0
    np.testing.assert_allclose(error.bias[unclamped], lobes[unclamped], atol=1e-9)
    assert (error.largest >= (lobes**2).max(axis=0) * (1 - 1e-9)).all()
    assert "by bias" in str(error)


@pytest.mark.parametrize(
    ("name", "how", "why"),
    [
        ("ward", {"loss": "plain"}, "searched for alpha_u"),
        ("koenderink", {"loss": "log"}, "the log loss is not linear"),
        ("koenderink", {"loss": "plain", "robust": "huber"}, "huber weighs samples by their"),
        ("eon", {"loss": "plain", "fixed": {"roughness": 0.3}}, "it holds squares of weights"),
    ],
)
def test_what_is_not_linear_is_refused(name, how, why):
    data = synthetic(bk.models()["lambert"](), n=60)
    fit = bk.fit(data, name, **how)
    said = rf"^{name}: its prediction is not linear .*{why}.*plain\.$"
    with pytest.raises(BrdfkitError, match=said):
        bk.uncertainty.prediction_error(fit, data)
    known = bk.fit(data, "ward", loss="plain", fixed={"alpha_u": 0.3})
    assert bk.uncertainty.prediction_error(known, data).variance.shape == (known.samples, 1)
