"""Data and settings of which no fit can be made, or none that is certain: one plain sentence."""

import numpy as np
import pytest
from measured_models import synthetic
from test_fit import Undefined, mirrored

import brdfkit as bk
from brdfkit.core.errors import BrdfkitError

UP = np.array([[0.0, 0.0, 1.0]])
OBLIQUE = np.array([[0.6, 0.0, 0.8]])


def of_values(values):
    """Measured values (n, channels) at random directions."""
    samples = synthetic(bk.models()["lambert"](), len(values)).samples
    channels = ("R", "G", "B")[: values.shape[1]]
    return bk.Measured.from_samples(samples.wi, samples.wo, values, channels=channels)


@pytest.mark.parametrize("loss", bk.losses.named.by_sample)
@pytest.mark.parametrize("name", ["ggx", "koenderink:order=4", "pca_polynomial", "ggx+ggx", "eon"])
def test_fewer_numbers_than_parameters(name, loss):
    """The fit meets them, claims no certainty, and says so."""
    data = bk.Measured.from_samples(OBLIQUE, UP, [[0.1, 0.2, 0.3]])
    fit = bk.fit(data, name, loss=loss)
    if name != "eon":  # which has a roughness and a weight
        assert fit.message.startswith("underdetermined: the values are some of many that meet")
        assert fit.degrees_of_freedom < 0
    np.testing.assert_allclose(fit.eval(OBLIQUE, UP), data.values, rtol=1e-6)
    assert np.isnan(np.concatenate([np.ravel(e) for e in fit.standard_errors.values()])).all()
    assert "1 sample," in str(fit)
    with pytest.raises(BrdfkitError, match=r"^A robust fit needs more samples than param"):
        bk.fit(data, name, loss=loss, robust="bisquare")


@pytest.mark.quick
def test_a_channel_without_values():
    values = np.full((20, 3), 0.2)
    values[:, 1] = np.nan
    said = r"no value of the channel G is finite; give the other channels alone\.$"
    with pytest.raises(BrdfkitError, match=f"^samples: {said}"):
        of_values(values)
    table = np.full((9, 9, 18, 3), 0.2)
    table[..., 1] = np.inf
    with pytest.raises(BrdfkitError, match=f"^table: {said}"):
        bk.Measured.from_table(table)
    with pytest.raises(BrdfkitError, match="no valid measurement is left"):
        of_values(np.full((20, 3), np.nan))


@pytest.mark.parametrize("loss", bk.losses.named.by_sample)
@pytest.mark.parametrize("constant", [0.3, 0.0, -0.2, 1e-30, 1e20])
def test_constant_data(constant, loss):
    """A diffuse term, or nothing at all; a search that ends, and a note."""
    fit = bk.fit(of_values(np.full((60, 3), constant)), "ggx", loss=loss)
    diffuse = np.pi * max(constant, 0)
    np.testing.assert_allclose(fit.values["diffuse_reflectance"], diffuse, rtol=1e-6)
    assert max(fit.values["specular_reflectance"]) <= 1e-6 * diffuse
    assert "stopped" not in fit.message
    assert "all measured values are equal: they tell nothing of a highlight's shape" in fit.notes


@pytest.mark.parametrize("robust", [None, "huber"])
@pytest.mark.parametrize("loss", ["log", "cosine"])
def test_a_black_channel_leaves_the_others_alone(loss, robust):
    """Of a channel that is 0 everywhere the weights are 0, and the shapes those of the others."""
    data = synthetic(bk.models()["ward"](diffuse_reflectance=(0.1, 0.2, 0.3)), n=300)
    noise = np.exp(0.1 * np.random.default_rng(0).normal(size=data.values.shape))
    values = data.values * noise * [1, 0, 1]
    black = bk.Measured.from_samples(data.samples.wi, data.samples.wo, values)
    fit = bk.fit(black, "ward", loss=loss, robust=robust)
    others = black.mix_channels(np.eye(3)[:, [0, 2]], ("R", "B"))
    alone = bk.fit(
        others.mix_channels(np.eye(2), ("650nm", "450nm")), "ward", loss=loss, spectral=True
    )
    assert fit.values["diffuse_reflectance"][1] == fit.values["specular_reflectance"][1] == 0
    if not robust:
        assert fit.values["alpha_u"] == pytest.approx(alone.values["alpha_u"], rel=1e-6)


@pytest.mark.quick
@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"bounds": {"alpha_u": (0.5, 0.1)}}, "alpha_u, 0.5 and 0.1, should be a low and a higher"),
        ({"bounds": {"alpha_u": (0.2, 0.2)}}, "alpha_u, 0.2 and 0.2, should be a low and a higher"),
        ({"bounds": {"alpha_u": (-1, 0.5)}}, "-1..0.5 of alpha_u should lie within 0.001..1"),
        ({"bounds": {"alpha_u": (0.1, np.nan)}}, "0.1..nan of alpha_u should lie within 0.001..1"),
        ({"fixed": {"alpha_u": np.nan}}, "alpha_u = nan is out of bounds: it should be between"),
    ],
)
def test_bounds_crossed_or_beyond(given, said):
    with pytest.raises(BrdfkitError, match=f"^ward: .*{said}.*[.]$"):
        bk.fit(of_values(np.full((20, 1), 0.2)), "ward", **given)


@pytest.mark.quick
def test_other_models_go_on_where_one_is_nan(tmp_path, no_user_plugins):
    """On the command line; the model and the direction are named, and the exit status is 2."""
    import json

    from click.testing import CliRunner

    from brdfkit.cli import main

    bk.save(mirrored(60), tmp_path / "mirrored.npz")
    Undefined.make_known()
    command = ["fit", str(tmp_path / "mirrored.npz"), "-m", "undefined", "-m", "lambert", "--json"]
    result = CliRunner().invoke(main, [*command, "--loss", "plain"])
    record = json.loads(result.stdout)
    assert [fit["model"] for fit in record["fits"]] == ["lambert"]
    assert record["failed"]["undefined"].startswith(
        "undefined: the lobe of reflectance is nan at theta_i"
    )
    assert "h is the normal; keep the formula finite there" in result.stderr
    assert result.exit_code == 2


@pytest.mark.quick
def test_unknown_names_propose_the_nearest():
    with pytest.raises(BrdfkitError, match="did you mean ward"):
        bk.models()["wrad"]
    with pytest.raises(BrdfkitError, match="did you mean log"):
        bk.losses.named["lgo"]
    assert bk.models().get("wrad") is None
    with pytest.raises(BrdfkitError, match="wrad"):
        bk.check({"type": "wrad"})


@pytest.mark.quick
def test_a_loss_that_weighs_nothing_is_refused():
    grey = of_values(np.full((40, 1), 0.2))
    nothing = bk.losses.Loss(
        "mine", "nothing", lambda m, d, ci, co: m - d, weights=lambda cos_i: 0 * cos_i
    )
    with pytest.raises(BrdfkitError, match="all weights are 0"):
        bk.fit(grey, "lambert", loss=nothing)


@pytest.mark.quick
def test_sigma_is_a_number():
    grey = of_values(np.full((40, 1), 0.2))
    fit = bk.fit(grey, "koenderink", loss="plain")
    with pytest.raises(BrdfkitError, match="sigma = 'a' should be a number"):
        bk.uncertainty.prediction_error(fit, grey, sigma="a")
