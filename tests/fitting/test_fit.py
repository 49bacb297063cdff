"""Fits: known parameters come back, published optima are met, and bad requests are refused."""

import copy
import pickle
from dataclasses import replace

import drjit as dr
import numpy as np
import pytest
from measured_models import synthetic
from random_models import random_model
from sample_sums import sample_sum

import brdfkit as bk
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.geometry.directions import from_angles
from brdfkit.core.geometry.vectors import half_vector
from brdfkit.materials.measured.selection import select_samples
from brdfkit.model import Model, shape, weight
from brdfkit.model.lobes import Cosine, Lobe, lambertian
from brdfkit.model.samples import Table
from brdfkit.regression import regress
from brdfkit.regression.problem.box_quadratic import minimise_in_box


def isotropic(model):
    """Random values with the anisotropic parameters tied, as a fit of them is.

    With seed 2 every lobe is seen below 80°, and none is of another kind than the default's.
    """
    if model.type_name() == "mixture":
        pytest.skip("several lobes have several minima: test_mixture.py")
    drawn = random_model(model, seed=2)
    own = {n: v for n, v in drawn.values.items() if not model.parameters[n].turns}
    return model(**own)


def given(truth, data):
    """Parameters that a fit takes from the geometry of the data and not from its values."""
    return {name: truth.values[name] for name in truth.determine_parameters(data.samples)}


# Parameters of which only the ratios count
HOMOGENEOUS = {"lafortune": ("c_x", "c_y", "c_z")}


def assert_same_parameters(found, truth):
    """To 1e-4, the homogeneous ones up to a common factor above 0; of an exponent near 0 to 1e-5,
    which is 1e-4 of the values where a cosine is 5e-5 and less elsewhere: its digits beyond that
    are rounding, and differ from machine to machine."""
    ratios = HOMOGENEOUS.get(truth.type_name(), ())
    factor = np.linalg.norm([truth.values[name] for name in ratios])
    factor = factor / np.linalg.norm([found.values[name] for name in ratios]) if ratios else 1.0
    for name, value in truth.values.items():
        own = np.multiply(found.values[name], factor if name in ratios else 1.0)
        least = 1e-5 if name.startswith("exponent") else 0.0
        np.testing.assert_allclose(own, value, rtol=1e-4, atol=least, err_msg=name)


# Models with more shape parameters have two highlights, which may take each other's place: they
# need many starts, which one loss is enough to show
FEW_SHAPES = 4


@pytest.mark.parametrize(
    ("loss", "starts"), [("cbrt", 16), *((loss, 4) for loss in bk.losses.named.by_sample)]
)
def test_known_parameters_come_back(model, loss, starts):
    """To 1e-4, from few starts and with the usual several ones."""
    truth = isotropic(model)
    if len(truth.shapes()) > FEW_SHAPES and starts < 16:
        pytest.skip("needs more starts")
    data = synthetic(truth, n=1000)
    found = bk.fit(data, truth.type_name(), loss=loss, starts=starts, fixed=given(truth, data))
    assert_same_parameters(found, truth)
    assert found.loss < 1e-5


def test_known_parameters_come_back_from_a_table(model):
    truth = isotropic(model)
    table = Table(np.full((24, 12, 24, 3), np.nan))
    wi, wo = table.directions()
    above = (wi[..., 2] > 0) & (wo[..., 2] > 0)
    table.values[above] = truth.eval(wi[above], wo[above])
    data = bk.Measured.from_table(table.values)
    starts = 16 if len(truth.shapes()) > FEW_SHAPES else None
    found = bk.fit(data, truth.type_name(), starts=starts, fixed=given(truth, data))
    assert_same_parameters(found, truth)


# Kurt 2007, digest of the optima on the RGB-averaged CUReT, one channel, k ≥ 0, α ≤ 0.5:
# (sample, model): loss, then shape parameters by name
CURET = {
    (12, "lambert"): (0.042722, {"diffuse_reflectance": 0.728533}),
    (12, "blinn_phong"): (0.036352, {"exponent": 10.479}),
    (12, "ward"): (0.024458, {"alpha_u": 0.43778}),
    (12, "ward_duer"): (0.008626, {"alpha_u": 0.41556}),
    (12, "cook_torrance"): (0.007487, {"alpha": 0.40746, "f0": 0.55425}),
    (12, "ashikhmin_shirley"): (0.006351, {"exponent_u": 5.4846}),
    (12, "lafortune"): (0.018148, {"exponent": 12.345}),
    (33, "lambert"): (0.015552, {"diffuse_reflectance": 0.094881}),
    (33, "blinn_phong"): (0.012181, {"exponent": 16.145}),
    (33, "ward"): (0.007699, {"alpha_u": 0.45220}),
    (33, "ward_duer"): (0.006815, {"alpha_u": 0.5}),
    (33, "cook_torrance"): (0.006672, {"alpha": 0.47657, "f0": 1.0}),
    (33, "ashikhmin_shirley"): (0.007541, {"exponent_u": 3.9448}),
    (33, "lafortune"): (0.004373, {"exponent": 4.6803}),
    (36, "lambert"): (0.023274, {"diffuse_reflectance": 0.346586}),
    (36, "blinn_phong"): (0.022754, {"exponent": 32.603}),
    (36, "ward"): (0.019474, {"alpha_u": 0.27011}),
    (36, "ward_duer"): (0.011467, {"alpha_u": 0.30381}),
    (36, "cook_torrance"): (0.003596, {"alpha": 0.45725, "f0": 0.0461}),
    (36, "ashikhmin_shirley"): (0.003159, {"exponent_u": 1.0047, "f0": 0.1195}),
    (36, "lafortune"): (0.004172, {"exponent": 15.9}),
}


@pytest.mark.parametrize(("sample", "name"), CURET)
def test_optima_on_curet(sample, name, measured_data):
    loss, expected = CURET[sample, name]
    data = bk.load(measured_data / "curet" / f"abrdf.dat#{sample}")
    bounds = {"alpha_u": (0.001, 0.5)} if name.startswith("ward") else {}
    found = bk.fit(data, name, loss="kurt", bounds=bounds)
    assert found.samples == 189
    assert found.loss == pytest.approx(loss, rel=3e-3)
    for parameter, value in expected.items():
        assert np.mean(found.values[parameter]) == pytest.approx(value, rel=1e-2), parameter


def test_large_tables_end_where_all_cells_say():
    """The starts see a part of the cells, the end all of them: no start may be better."""
    data = bk.load("red_plastic")
    found = bk.fit(data, "ggx")
    assert found.samples > 40_000
    again = bk.fit(data, "ggx", seed=3)
    assert again.loss == pytest.approx(found.loss, rel=1e-6)


def test_reproducible_to_the_last_digit():
    data = synthetic(bk.models()["ggx"]())
    first, second = (bk.fit(data, "ggx", loss="cbrt") for _ in range(2))
    assert first.values == second.values
    assert first.loss == second.loss


@pytest.mark.quick
def test_fit_is_plain_data(tmp_path):
    """Saved and loaded, pickled and copied, a fit is the same material."""
    found = bk.fit(synthetic(bk.models()["ward"]()), "ward", starts=1)
    bk.save(found, tmp_path / "ward.json")
    wi, wo = from_angles([0.5], [0.0]), from_angles([0.6], [3.0])
    for other in (
        bk.load(tmp_path / "ward.json"),
        pickle.loads(pickle.dumps(found)),
        copy.deepcopy(found),
    ):
        assert other.values == found.values
        assert other.loss == found.loss
        np.testing.assert_array_equal(other.eval(wi, wo), found.eval(wi, wo))


@pytest.mark.quick
def test_what_sits_on_a_bound_is_named():
    data = synthetic(bk.models()["ward"](alpha_u=0.4))
    found = bk.fit(data, "ward", bounds={"alpha_u": (0.01, 0.3)})
    assert found.at_bounds == ("alpha_u",)
    assert found.values["alpha_u"] == pytest.approx(0.3)
    assert "on its bound" in str(found)


@pytest.mark.quick
def test_a_lobe_that_is_not_there_is_named():
    """A facet model without its tails would want less than nothing diffuse: it gets none."""
    samples = select_samples(synthetic(bk.models()["ggx"](diffuse_reflectance=0.0)), 80.0)
    loss, bounds = bk.losses.named["kurt"], {"exponent": (0.1, 2.0)}
    found = regress(bk.models()["blinn_phong"], samples, loss, bounds=bounds)
    assert found.weights[0, 0] == 0
    assert "diffuse_reflectance" in found.at_bounds


@pytest.mark.quick
def test_anisotropy_comes_back_where_it_is_asked_for():
    truth = bk.models()["ward"](alpha_u=0.1, alpha_v=0.35)
    found = bk.fit(synthetic(truth), "ward", anisotropic=True)
    for name, value in truth.values.items():
        np.testing.assert_allclose(found.values[name], value, rtol=1e-4, err_msg=name)


def test_anisotropy_is_searched_where_it_was_measured():
    """Grooves along x, ten times as steep across; the other material knows no azimuth."""
    brushed = bk.load("brushed_aluminium")
    found = bk.fit(brushed, "ward_duer")
    assert found.values["alpha_v"] > 2 * found.values["alpha_u"]
    assert found.settings["anisotropic"]
    log = sample_sum("log")  # without a term for the albedo, which both would pay for
    found, tied = (bk.fit(brushed, "ward_duer", loss=log, anisotropic=how) for how in (None, False))
    assert tied.values["alpha_u"] == tied.values["alpha_v"]
    assert found.loss < 0.5 * tied.loss
    blasted = bk.fit(bk.load("blasted_gold"), "ward_duer")
    assert blasted.values["alpha_u"] == blasted.values["alpha_v"]


@pytest.mark.parametrize(("c_x", "c_y"), [(0.5, 0.5), (-0.9, 0.4), (-0.6, -0.9)])
def test_lafortunes_other_lobes_come_back(c_x, c_y):
    """Towards the light and across it, though the default looks the other way."""
    truth = bk.models()["lafortune"](c_x=c_x, c_y=c_y, c_z=0.7, exponent=20)
    found = bk.fit(synthetic(truth), "lafortune", anisotropic=c_x != c_y)
    assert_same_parameters(found, truth)


def test_a_black_material_is_fitted():
    data = synthetic(bk.models()["lambert"](diffuse_reflectance=0.0), n=50)
    for loss in bk.losses.named.by_sample:
        found = bk.fit(data, "ward", loss=loss, starts=2)
        assert found.loss < 1e-9
        assert found.values["diffuse_reflectance"][0] < 1e-9


@pytest.mark.quick
def test_one_sample_is_fitted():
    """At normal incidence, where the loss kurt, weighted by sin θ_i, has nothing to say."""
    up = np.array([[0.0, 0.0, 1.0]])
    data = bk.Measured.from_samples(up, up, [[0.1, 0.2, 0.3]])
    found = bk.fit(data, "lambert")
    np.testing.assert_allclose(found.values["diffuse_reflectance"], np.pi * data.values[0])
    compared = bk.compare(data, found)
    assert np.isnan(compared.errors["lambert"].pop("kurt"))
    assert max(compared.errors["lambert"].values()) < 1e-9
    measured, lambert = (line.split() for line in str(compared).splitlines()[2:])
    assert measured == ["measured", *"-------"]
    assert lambert == ["lambert", *["0.00000"] * 4, *["0.63"] * 3]
    with pytest.raises(BrdfkitError, match="kurt loss weighs no sample"):
        bk.fit(data, "lambert", loss="kurt")


def test_compare_finds_the_light_of_the_fit_and_marks_what_is_wrong():
    """By the quadrature of the fit; of a model, the one that refines."""
    data, light = bk.load("red_plastic"), bk.load("plaster")
    found, narrow = bk.fit(data, "ward"), bk.models()["ggx"](alpha_u=0.01)
    compared = bk.compare(data, [found, narrow, light, {"type": "diffuse"}])
    assert compared.measured_albedo == pytest.approx(data.albedo.values[:3].mean(axis=1))
    assert compared.albedos["ward"] == pytest.approx(np.mean(found.albedo.fit[:3], axis=1))
    wi = from_angles(np.radians([5, 45, 75]), np.zeros(3))
    refined = [bk.albedo(narrow, direction).mean() for direction in wi]
    assert compared.albedos["ggx"] == pytest.approx(refined, rel=1e-4)
    assert compared.albedos["plaster"] == light.albedo.means
    assert compared.albedos["diffuse"] == pytest.approx([0.5] * 3, rel=1e-4)
    lines = str(compared).splitlines()
    assert [line.count("!") for line in lines] == [0, 0, 0, 1, 3, 3, 3]
    assert max(map(len, lines)) <= 80
    assert compared.shown == ("cosine", "log", "cbrt", "plain")
    assert "kurt" in str(bk.compare(data, bk.fit(data, "lambert", loss="kurt")))


def test_print_tells_the_light_its_warnings_and_samples_that_count_little():
    found = bk.fit(bk.load("red_plastic"), "lambert")
    (warning,) = found.warnings
    assert warning in found.notes
    said = str(found).splitlines()
    albedo = f"{np.mean(found.albedo.fit[0]):.2f}"
    assert (
        f"  albedo at 5°, 45°, 75°: {', '.join([albedo] * 3)}; measured: 0.23, 0.24, 0.34" in said
    )
    assert f"  ! {warning}" in said
    assert "converged, but its light is wrong; 116,498 samples, " in said[-1]
    assert "worth" not in said[-1]
    wi, wo = from_angles(np.full(40, 0.3), np.zeros(40)), from_angles(np.linspace(0, 0.7, 40), 3.0)
    few = bk.Measured.from_samples(wi, wo, np.linspace(0.1, 0.3, 40))
    weights = np.r_[np.ones(10), np.full(30, 1e-6)]
    found = bk.fit(few, "lambert", weights=weights)
    assert found.unrepresented > 0.5
    said = str(found).splitlines()
    assert said[2].endswith("measured: -, -, -")
    share = f"none for {found.unrepresented:.0%} of the directions, "
    assert f"; 40 samples, worth {found.effective_samples:.0f} of equal weight, {share}" in said[-1]
    older = str(replace(found, albedo=None, effective_samples=0.0, unrepresented=0.0))
    assert "albedo" not in older
    assert "; 40 samples, " + said[-1].split(share)[1] in older


def test_fixed_parameter_stays():
    data = synthetic(bk.models()["ggx"](f0=0.2))
    found = bk.fit(data, "ggx", fixed={"f0": 0.04})
    assert found.values["f0"] == 0.04
    assert found.loss > 0.01


def test_metrics_agree_with_the_fit():
    """`compare`, which evaluates in NumPy, finds the loss that the fit reported."""
    data = synthetic(random_model(bk.models()["ggx"], 3))
    for loss in bk.losses.named.by_sample:
        found = bk.fit(data, "ward", loss=loss)
        assert bk.compare(data, found).errors["ward"][loss] == pytest.approx(found.loss, rel=1e-9)


def test_without_derivatives_the_fit_is_the_same(monkeypatch):
    """The fallback without LLVM: scalar arrays and finite differences."""
    import drjit as dr

    from brdfkit.core.jit import double_precision

    data = synthetic(bk.models()["cook_torrance"](alpha=0.3, f0=0.2), n=500)
    exact = bk.fit(data, "cook_torrance")
    monkeypatch.setattr(double_precision, "choose_float_type", lambda: dr.scalar.ArrayXf64)
    assert not double_precision.has_derivatives()
    slow = bk.fit(data, "cook_torrance")
    for name, value in exact.values.items():
        np.testing.assert_allclose(slow.values[name], value, rtol=1e-4)


class InNoFile(Model):
    """A model of a notebook's cell."""

    diffuse_reflectance = weight(0.4, "")

    def lobes(self):
        return (lambertian(),)


def test_a_class_stands_for_its_name():
    data = synthetic(bk.models()["lambert"](), n=50)
    coupled = bk.models()["ashikhmin_shirley"].configured(diffuse="coupled")
    assert bk.fit(data, coupled, starts=1).name == "ashikhmin_shirley:diffuse=coupled"


def test_a_class_in_no_file_is_a_model(no_user_plugins, llvm_variant):
    """It is fitted, summed, checked, rendered and pickled; its name is that of the class."""
    data = synthetic(bk.models()["lambert"](), n=200)
    found = bk.fit(data, InNoFile, starts=1)
    assert found.name == "in_no_file"
    lambert = bk.fit(data, "lambert")
    assert found.values["diffuse_reflectance"] == lambert.values["diffuse_reflectance"]
    assert "in_no_file" in bk.models()
    assert bk.fit(data, "in_no_file+ward", starts=1).name == "in_no_file+ward"
    assert bk.check(found, only=["plugin is formula"])
    assert bk.render(found, spp=1, size=4).pictures["in_no_file"].max() > 0
    assert pickle.loads(pickle.dumps(found)) == found


@pytest.mark.quick
def test_weights_that_may_be_negative_have_no_bound():
    data = synthetic(bk.models()["lambert"](diffuse_reflectance=0.0), n=50)
    assert bk.fit(data, "koenderink", loss="plain").at_bounds == ()
    assert bk.fit(data, "lambert", loss="plain").at_bounds == ("diffuse_reflectance",)


@pytest.mark.quick
@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"model": "wrad"}, ["'wrad'", "ward_duer"]),
        ({"loss": "l2"}, ["'l2'", "cosine, log, cbrt, plain"]),
        ({"bounds": {"alpha_w": (0, 1)}}, ["'alpha_w'", "alpha_u"]),
        ({"bounds": {"alpha_u": (0.5, 0.1)}}, ["alpha_u", "0.001..1"]),
        ({"bounds": {"alpha_u": (0.1, 7.0)}}, ["alpha_u", "0.001..1"]),
        ({"fixed": {"alpha_u": 9.0}}, ["alpha_u = 9.0", "between 0.001 and 1"]),
        ({"fixed": {"diffuse_reflectance": 0.5}}, ["diffuse_reflectance", "not searched"]),
        ({"bounds": {"alpha_v": (0.1, 0.2)}}, ["alpha_v", "not searched"]),
        ({"bounds": {"alpha_u": (0.1, 0.2)}, "fixed": {"alpha_u": 0.1}}, ["alpha_u", "choose one"]),
        ({"starts": 0}, ["starts = 0"]),
        ({"max_angle": 0.0}, ["max_angle", "at most 90"]),
        ({"max_angle": -3.0}, ["max_angle = -3.0"]),
        ({"max_angle": 300.0}, ["max_angle = 300.0"]),
        ({"max_angle": "80"}, ["max_angle = '80'"]),
        ({"bounds": {"alpha_u": 0.5}}, ["alpha_u = 0.5", "(low, high)"]),
        ({"bounds": 0.5}, ["bounds = 0.5", "dictionary"]),
        ({"fixed": {"alpha_u": None}}, ["alpha_u", "None", "a number"]),
        ({"fixed": ["alpha_u"]}, ["fixed", "dictionary"]),
        ({"starts": "3"}, ["starts = '3'", "whole number"]),
        ({"starts": 2.5}, ["starts = 2.5"]),
        ({"seed": -1}, ["seed = -1", "at least 0"]),
        ({"loss": ["log"]}, ["['log']", "cosine, log"]),
        ({"model": 3}, ["int", "ward"]),
        ({"model": "wrad"}, ["'wrad'", "did you mean ward?"]),
        ({"material": "car_pant"}, ["'car_pant'", "did you mean car_paint?"]),
        ({"material": InNoFile()}, ["is a model", "fit(material, model)"]),
    ],
)
def test_bad_requests_are_refused(arguments, words):
    data = synthetic(bk.models()["lambert"](), n=50)
    with pytest.raises(BrdfkitError) as caught:
        bk.fit(**{"model": "ward", "material": data, **arguments})
    for word in words:
        assert word in str(caught.value)
    assert str(caught.value).count("\n") == 0


@pytest.mark.quick
@pytest.mark.parametrize(
    ("verb", "models", "order"),
    [
        (bk.fit, "ggx", "fit(material, model)"),
        (bk.fit, bk.Model, "fit(material, model)"),
        (bk.rank, ["ward", "ggx+ggx"], "rank(material, models)"),
        (bk.compare, InNoFile(), "compare(material, fits)"),
    ],
)
def test_a_model_in_the_place_of_the_material_is_refused_with_the_order(verb, models, order):
    with pytest.raises(BrdfkitError) as caught:
        verb(models, "plaster")
    assert f"is a model, where the measured material belongs: {order}." in str(caught.value)


@pytest.mark.quick
def test_minimise_in_box_meets_the_optimality_conditions():
    """Columns of unlike sizes, several problems at a time, bounds of both kinds and of none."""
    rng = np.random.default_rng(0)
    for n in range(1, 9):
        factor = rng.normal(size=(100, n + 2, n)) * 10.0 ** rng.integers(-4, 4, (100, 1, n))
        hessian = factor.transpose(0, 2, 1) @ factor
        scale = np.sqrt(hessian.diagonal(axis1=1, axis2=2))
        gradient = rng.normal(size=(100, n)) * scale
        middle = rng.normal(size=(100, n)) / scale
        low = np.where(rng.random((100, n)) < 0.3, -np.inf, middle)
        high = np.where(rng.random((100, n)) < 0.3, np.inf, middle + 1 / scale)
        z = minimise_in_box(hessian, gradient, low, high)
        z, low, high = (x * scale for x in (z, low, high))
        assert ((low <= z + 1e-12) & (z <= high + 1e-12)).all()
        slope = (hessian @ (z / scale)[..., None])[..., 0] / scale + gradient / scale
        assert (slope[z < high - 1e-9] > -1e-7).all()
        assert (slope[z > low + 1e-9] < 1e-7).all()


class Undefined(Model):
    """NaN at some mirror directions: rounding takes h.z to a little above 1."""

    reflectance = weight(0.4, "")
    p = shape(0.5, (0.1, 2.0), "")

    def lobes(self):
        return (Lobe(lambda wi, wo: (1 - half_vector(wi, wo).z) ** self.p, Cosine()),)


class UndefinedDerivative(Undefined):
    """Infinite at the default where both angles are equal."""

    p = shape(0.5, (0.5, 2.0), "")

    def lobes(self):
        def value(wi, wo):
            return dr.sqrt(self.p - 0.5 + dr.square(wi.z - wo.z))

        return (Lobe(value, Cosine()),)


def mirrored(n=500):
    """A material measured at mirror directions, and seen from above."""
    wi = from_angles(np.linspace(0.01, 1.3, n), 0.0)
    above = np.broadcast_to([0.0, 0.0, 1.0], wi.shape)
    wi, wo = np.concatenate([wi, wi]), np.concatenate([wi * [-1, 1, 1], above])
    return bk.Measured.from_samples(wi, wo, np.full(2 * n, 0.3), channels=("Y",))


@pytest.mark.quick
@pytest.mark.parametrize(
    ("model", "said"),
    [
        (Undefined, "^undefined: the lobe of reflectance is nan at theta_i"),
        (UndefinedDerivative, "^undefined_derivative: the derivative by p of the lobe of reflec"),
    ],
)
def test_a_formula_that_is_not_finite_is_named(model, said, no_user_plugins):
    with pytest.raises(BrdfkitError, match=rf"{said}.*Δφ 180°, where h is the normal; keep"):
        bk.fit(mirrored(), model, loss="plain", starts=1)


def test_too_few_numbers_are_noted():
    up = [[0.0, 0.0, 1.0]]
    one = bk.Measured.from_samples(up, up, [[0.2, 0.3, 0.4]])
    assert any(n.startswith("3 numbers were measured for 7") for n in bk.fit(one, "ward").notes)
    assert not any("were measured for" in note for note in bk.fit(one, "lambert").notes)


@pytest.mark.quick
def test_negatives_out_of_gamut_are_told_from_measured_ones():
    """A saturated green laser: no wavelength is negative, its red is."""
    wi = from_angles(np.linspace(0, 1.2, 20), 0.0)
    names = tuple(f"{nm}nm" for nm in range(400, 701, 20))
    values = np.zeros((20, len(names)))
    values[:, names.index("520nm")] = 0.5
    green = bk.Measured.from_samples(wi, wi, values, channels=names, name="green")
    (note,) = (note for note in bk.fit(green, "lambert").notes if "negative" in note)
    assert "in linear sRGB are negative and count as 0, though none was measured so" in note
    noisy = bk.Measured.from_samples(wi, wi, values - 0.01, channels=names)
    (note,) = (note for note in bk.fit(noisy, "lambert").notes if "negative" in note)
    assert "of the measured values are negative and count as 0" in note
