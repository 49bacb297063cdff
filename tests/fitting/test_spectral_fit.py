"""Spectral fits: shapes shared by all wavelengths, a weight for each; rendered in every variant."""

import pickle

import numpy as np
import pytest
from measured_models import synthetic
from test_fit import assert_same_parameters

import brdfkit as bk
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.geometry.directions import from_angles
from brdfkit.materials.converting import evaluate_on_grid

WAVELENGTHS = (400.0, 460.0, 500.0, 530.0, 570.0, 600.0, 640.0, 655.5, 660.0, 700.0)
UP = np.array([[0.0, 0.0, 1.0]])


def spectral(name, wavelengths=WAVELENGTHS, **shapes):
    """A model whose weights are smooth spectra."""
    nm, model = np.array(wavelengths), bk.models()[name]
    spectra = {
        weight: 0.3 + 0.1 * np.sin(nm / 80 + k) for k, weight in enumerate(model.weights(), 1)
    }
    return model(wavelengths=wavelengths, **spectra, **shapes)


def measured(model, n=400, noise=0.0):
    """A spectral model measured at random directions."""
    samples = synthetic(bk.models()["lambert"](), n).samples
    values = model.eval(samples.wi, samples.wo)
    values = values * np.exp(noise * np.random.default_rng(1).normal(size=values.shape))
    channels = [f"{nm:g}nm" for nm in model.wavelengths]
    return bk.Measured.from_samples(samples.wi, samples.wo, values, channels=channels)


@pytest.mark.parametrize("loss", ["log", "cosine"])
def test_known_spectra_come_back(loss):
    """More channels than one kernel evaluates, in no order; E is that of `compare`."""
    truth = spectral("ggx", WAVELENGTHS[::-1], alpha_u=0.15, f0=0.3)
    data = measured(truth)
    fit = bk.fit(data, "ggx", loss=loss, spectral=True)
    assert_same_parameters(fit, truth)
    assert fit.wavelengths == truth.wavelengths
    assert fit.eval(UP, UP).shape == (1, 10)
    other = bk.fit(data, "ward", loss=loss, spectral=True)
    errors = bk.compare(data, other, spectral=True).errors["ward"]
    assert errors[loss] == pytest.approx(other.loss, rel=1e-9)
    assert other.loss > 10 * fit.loss


@pytest.mark.parametrize("robust", [None, "huber"])
def test_of_known_shapes_each_wavelength_is_a_fit_of_its_own(robust):
    data = measured(spectral("ward", alpha_u=0.2), noise=0.1)
    given = {"fixed": {"alpha_u": 0.2}, "loss": "plain", "robust": robust}
    fit = bk.fit(data, "ward", spectral=True, **given)
    for c in (0, 7, 9):  # of two groups that one kernel evaluates
        channel = data.channels[c]
        alone = bk.fit(data.mix_channels(np.eye(10)[:, [c]], [channel]), "ward", **given)
        for name in ("diffuse_reflectance", "specular_reflectance"):
            np.testing.assert_allclose(fit.values[name][c], alone.values[name][0], rtol=1e-6)
            own = fit.standard_errors[name][c], alone.standard_errors[name][0]
            np.testing.assert_allclose(*own, rtol=1e-4)


def test_its_rgb_is_the_fit_in_rgb():
    """A linear loss: to mix the channels and to fit may change places."""
    data = measured(spectral("ward", alpha_u=0.2), noise=0.1)
    given = {"fixed": {"alpha_u": 0.25}, "loss": "cosine"}
    fit, rgb = (bk.fit(data, "ward", spectral=s, **given) for s in (True, False))
    for name, value in rgb.values.items():
        np.testing.assert_allclose(fit.rgb.values[name], value, rtol=1e-6)
    wi, wo = data.samples.wi, data.samples.wo
    np.testing.assert_allclose(fit.rgb.eval(wi, wo), rgb.eval(wi, wo), rtol=1e-6)
    both = bk.compare(data, [fit, rgb]).errors
    assert both["ward"]["log"] == pytest.approx(both["ward (2)"]["log"], rel=1e-6)
    left, rgb_left = fit.residuals(data), rgb.residuals(data)
    assert left.channels == data.channels
    rows = left.samples.valid
    np.testing.assert_allclose(left.rgb.values[rows], rgb_left.values[rows], atol=1e-6)
    bk.plot([data, fit])


def test_standard_errors_count_at_every_wavelength():
    data = measured(spectral("ward"), noise=0.1)
    errors = np.where(np.arange(len(data.values)) % 2, 0.2, 1e-3)[:, None] * np.ones(10)
    noisy = data.values + errors * np.random.default_rng(0).normal(size=errors.shape)
    given = {"channels": data.channels, "standard_error": errors}
    data = bk.Measured.from_samples(data.samples.wi, data.samples.wo, noisy, **given)
    fit = bk.fit(data, "ward", loss="plain", spectral=True)
    assert any(note.startswith("samples count by their standard errors") for note in fit.notes)
    assert fit.values["alpha_u"] == pytest.approx(0.2, rel=0.1)


def test_it_is_rendered_as_the_measurement(llvm_variant):
    """A Lambertian material, which a fit meets exactly, at wavelengths within and beyond."""
    import drjit as dr
    import mitsuba as mi

    data = measured(spectral("lambert"))
    fit = bk.fit(data, "lambert", spectral=True)
    wavelengths = (380.0, 452.0, 651.0, 720.0)
    expected = np.interp(wavelengths, WAVELENGTHS, fit.values["diffuse_reflectance"]) / np.pi
    for variant in ("llvm_ad_spectral", "llvm_ad_rgb", "llvm_ad_mono"):
        mi.set_variant(variant)
        si = dr.zeros(mi.SurfaceInteraction3f, 1)
        si.wi, si.sh_frame = mi.Vector3f(0, 0, 1), mi.Frame3f([0, 0, 1])
        if mi.is_spectral:
            si.wavelengths = wavelengths
        values = []
        for thing in (data, fit):
            bsdf = mi.load_dict(thing.scene_dict())
            values.append(np.ravel(bsdf.eval(mi.BSDFContext(), si, mi.Vector3f(0, 0, 1))))
        np.testing.assert_allclose(*values, rtol=1e-4)
        if mi.is_spectral:
            np.testing.assert_allclose(values[1], expected, rtol=1e-5)
            assert bk.check(fit, only=["plugin is formula"])


def test_it_is_plain_data(tmp_path):
    """Saved, pickled, changed, printed in a few words."""
    fit = bk.fit(measured(spectral("ward"), noise=0.1), "ward", spectral=True, starts=1)
    bk.save(fit, tmp_path / "fit.json")
    assert bk.load(tmp_path / "fit.json") == fit
    assert pickle.loads(pickle.dumps(fit)) == fit
    model = fit.model
    assert model.changed(alpha_u=0.5).wavelengths == WAVELENGTHS
    assert model != type(model)(wavelengths=[w + 1 for w in WAVELENGTHS], **model.values)
    assert hash(model) == hash(model.changed())
    assert "wavelengths=[10 from 400 to 700], diffuse_reflectance=[10 from" in repr(model)
    lines = str(fit).splitlines()
    assert " nm to " in lines[1]
    assert lines[1].endswith(" in the median")
    assert max(map(len, lines)) < 100


def test_files_of_it_have_the_wavelengths(tmp_path):
    model = spectral("lambert")
    bk.save(model, tmp_path / "model.bsdf")
    back = bk.load(tmp_path / "model.bsdf")
    channels = tuple(f"{w:g}nm" for w in WAVELENGTHS)
    assert back.channels == evaluate_on_grid(model).channels == channels
    np.testing.assert_allclose(back.eval(UP, UP), model.eval(UP, UP), rtol=1e-3)


def test_what_has_no_spectrum_is_refused(llvm_variant):
    rgb = synthetic(bk.models()["ward"](diffuse_reflectance=(0.1, 0.2, 0.3)), n=20)
    with pytest.raises(BrdfkitError, match="the channels R G B, not at wavelengths; leave"):
        bk.fit(rgb, "ward", spectral=True)
    lambert, koenderink = bk.models()["lambert"], bk.models()["koenderink"]
    with pytest.raises(BrdfkitError, match="should be a number, or 2, one per wavelength"):
        lambert(wavelengths=(400, 500), diffuse_reflectance=(0.1, 0.2, 0.3))
    with pytest.raises(BrdfkitError, match=r"wavelengths = \(400, 400\) should be different"):
        lambert(wavelengths=(400, 400))
    with pytest.raises(
        BrdfkitError, match="3 channels and samples 10; compare materials with equal"
    ):
        bk.compare(
            measured(spectral("lambert")),
            lambert(diffuse_reflectance=(1, 1, 1)),
            max_angle=80,
            spectral=True,
        )
    negative = koenderink(wavelengths=(400, 700), **{koenderink.weights()[0]: (-0.1, 0.2)})
    llvm_variant.set_variant("llvm_ad_spectral")
    with pytest.raises(BrdfkitError, match=r"a spectrum with a value below 0.* as \.bsdf"):
        negative.scene_dict()
    black = lambert(wavelengths=(400, 700), diffuse_reflectance=(0, 0))
    assert black.scene_dict()["diffuse_reflectance"] == 0
    narrow = lambert(wavelengths=(500, 550), diffuse_reflectance=(1, 1))
    assert narrow.scene_dict()["diffuse_reflectance"]["type"] == "irregular"
    with pytest.raises(BrdfkitError, match="500 to 550 nm, do not span"):
        _ = narrow.rgb


def test_a_measured_paint_is_fitted_at_31_wavelengths(measured_data):
    data = bk.load(measured_data / "cornell" / "cayman.brdf")
    fit = bk.fit(data, "ggx", spectral=True)
    assert len(fit.values["specular_reflectance"]) == 31
    best = bk.fit(data, "ggx", spectral=True, starts=40, seed=1)
    assert fit.loss == pytest.approx(best.loss, rel=1e-6)
    wi = from_angles(np.linspace(0, 1, 5), 0.0)
    assert (fit.eval(wi, wi) >= 0).all()
