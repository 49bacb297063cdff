"""Bootstrap and profile: the same certainty as the formulas', where these hold."""

import numpy as np
import pytest
from measured_models import noisy, synthetic

import brdfkit as bk
from brdfkit.core.errors import BrdfkitError


# Of 400 samples one has a leverage of 0.27 on Koenderink's basis, where the bootstrap differs more
@pytest.mark.parametrize(
    ("name", "loss", "n"), [("koenderink", "plain", 2000), ("ggx", "log", 400)]
)
def test_the_bootstrap_has_the_standard_errors_of_the_sandwich(name, loss, n):
    """Within 15 %, for noise in proportion to the values of the model itself."""
    weight = bk.models()[name].weights()[0]
    data = noisy(bk.models()[name](**{weight: (0.1, 0.2, 0.3)}), n, size=0.1)
    fit = bk.fit(data, name, loss=loss)
    found = bk.uncertainty.bootstrap(fit, data, draws=200)
    for parameter, error in fit.standard_errors.items():
        ratio = found.standard_errors[parameter] / np.array(error)
        np.testing.assert_allclose(ratio, 1, atol=0.15, err_msg=parameter)
        low, high = np.reshape(found.intervals()[parameter], (-1, 2)).T
        assert (low < fit.values[parameter]).all()
        assert (high > fit.values[parameter]).all()
    assert str(found).count(" ± ") == sum(np.size(v) for v in fit.values.values())


@pytest.mark.parametrize("robust", [None, "huber"])
def test_a_fit_of_the_bootstrap_is_a_fit_with_weights(robust):
    """Whole numbers as weights, by the same draws; all starts against the end of the fit."""
    data = noisy(bk.models()["ward"](diffuse_reflectance=(0.1, 0.2, 0.3)), n=120, size=0.1)
    fit = bk.fit(data, "ward", robust=robust)
    found, rng = bk.uncertainty.bootstrap(fit, data, draws=2, seed=5), np.random.default_rng(5)
    (rows,) = np.nonzero(data.samples.within(80))
    for number in range(2):
        times = np.zeros(120)
        times[rows] = np.bincount(rng.integers(len(rows), size=len(rows)), minlength=len(rows))
        alone = bk.fit(data, "ward", robust=robust, weights=times)
        for parameter, value in alone.values.items():
            np.testing.assert_allclose(found.estimates[parameter][number], value, rtol=1e-5)


def test_the_profile_has_the_interval_of_the_formula():
    """Many samples, so that the problem is nearly quadratic; each point is a fit of its own."""
    data = noisy(bk.models()["ward"](diffuse_reflectance=(0.1, 0.2, 0.3)), n=1500, size=0.1)
    fit = bk.fit(data, "ward")
    found = bk.uncertainty.profile(fit, data, parameter="alpha_u", points=9)
    half = np.diff(fit.intervals["alpha_u"])[0] / 2
    np.testing.assert_allclose(found.interval, fit.intervals["alpha_u"], atol=0.05 * half)
    assert found.losses[4] == found.losses.min() == fit.loss
    for k in (0, 7):
        fixed = bk.fit(data, "ward", fixed={"alpha_u": found.values[k]})
        assert found.losses[k] == pytest.approx(fixed.loss, rel=1e-9)
    assert str(found).startswith("alpha_u = ")
    assert found.plot()._repr_png_().startswith(b"\x89PNG")


def test_a_profile_ends_on_a_bound():
    """A rough highlight: nothing tells a width above it."""
    data = noisy(bk.models()["ward"](alpha_u=0.4), n=60, size=0.3)
    fit = bk.fit(data, "ward", bounds={"alpha_u": (0.3, 0.45)})
    low, high = bk.uncertainty.profile(fit, data, parameter="alpha_u", points=9).interval
    assert 0.3 <= low < fit.values["alpha_u"] <= high <= 0.45
    assert low == 0.3 or high == 0.45


def test_what_has_no_profile_or_bootstrap_is_refused():
    data = noisy(bk.models()["ward"](), n=60)
    robust, plain = (bk.fit(data, "ward", robust=r) for r in ("huber", None))
    with pytest.raises(BrdfkitError, match=r"alpha was not searched, so it has no profile;"):
        bk.uncertainty.profile(plain, data, parameter="alpha")
    with pytest.raises(BrdfkitError, match="the fit is robust, and minimises no loss"):
        bk.uncertainty.profile(robust, data, parameter="alpha_u")
    one = bk.Measured.from_samples([[0.6, 0, 0.8]], [[0, 0, 1]], [0.2], channels=("Y",))
    with pytest.raises(BrdfkitError, match="has no number to spare, so it has no profile"):
        bk.uncertainty.profile(bk.fit(one, "ward"), one, parameter="alpha_u")
    with pytest.raises(BrdfkitError, match="give the material that was fitted, and fit it without"):
        bk.uncertainty.bootstrap(plain, noisy(bk.models()["ward"](), n=60, seed=1))
    with pytest.raises(BrdfkitError, match="draws = 1 should be a whole number, at least 2"):
        bk.uncertainty.bootstrap(plain, data, draws=1)
    samples = synthetic(bk.models()["ward"](), n=60).samples
    errors = np.full((60, 1), 0.1)
    known = bk.Measured.from_samples(
        samples.wi, samples.wo, samples.values, channels=("Y",), standard_error=errors
    )
    with pytest.raises(BrdfkitError, match="use_standard_error=False first"):
        bk.uncertainty.bootstrap(bk.fit(known, "ward"), known)
