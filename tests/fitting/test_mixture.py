"""Several lobes over one diffuse term: named by a sum, fitted, saved and rendered as one model."""

import pickle

import numpy as np
import pytest

import brdfkit as bk
from brdfkit.checks.material_subject import draw_direction_pairs
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.geometry.directions import from_angles
from brdfkit.materials.measured.selection import select_samples
from brdfkit.model import labels


@pytest.mark.quick
def test_a_mixture_is_the_sum_of_its_parts():
    ggx, ward = bk.models()["ggx"], bk.models()["ward"]
    both = labels.model("ggx+ward")(
        diffuse_reflectance=0.3,
        ggx_1_specular_reflectance=0.4,
        ggx_1_alpha_u=0.3,
        ggx_1_f0=0.2,
        ward_2_specular_reflectance=0.1,
        ward_2_alpha_u=0.05,
    )
    parts = (
        ggx(diffuse_reflectance=0.3, specular_reflectance=0.4, alpha_u=0.3, f0=0.2),
        ward(diffuse_reflectance=0.0, specular_reflectance=0.1, alpha_u=0.05),
    )
    pairs = draw_direction_pairs(1000, seed=0)
    np.testing.assert_allclose(both.eval(*pairs), sum(p.eval(*pairs) for p in parts), rtol=1e-12)


@pytest.mark.parametrize("label", ["eon+blinn_phong+ggx", "ggx+ward_duer", "ward+ward+ward"])
def test_any_sum_passes_the_checks(label, llvm_variant):
    report = bk.check(labels.model(label)())
    assert report, str(report)


def test_two_lobes_come_back():
    truth = labels.model("ggx+ggx")(
        diffuse_reflectance=(0.1, 0.2, 0.3),
        ggx_1_specular_reflectance=(0.4, 0.3, 0.2),
        ggx_1_alpha_u=0.4,
        ggx_2_specular_reflectance=(0.1, 0.1, 0.1),
        ggx_2_alpha_u=0.06,
        ggx_2_f0=0.05,
    )
    pairs = draw_direction_pairs(4000, seed=3, max_degrees=79)
    data = bk.Measured.from_samples(*pairs, truth.eval(*pairs))
    found = bk.fit(data, "ggx+ggx")
    np.testing.assert_allclose(found.eval(*pairs), truth.eval(*pairs), rtol=1e-4)


def test_a_second_lobe_fits_better():
    data = bk.load("car_paint")
    one, two = bk.fit(data, "ggx"), bk.fit(data, "ggx+ggx")
    assert two.loss < one.loss / 3


@pytest.mark.quick
def test_a_mixture_is_plain_data(tmp_path):
    model = labels.model("lambert+ward")(ward_2_alpha_u=0.1)
    copy = pickle.loads(pickle.dumps(model))
    assert copy.name == "lambert+ward"
    assert copy.values == model.values
    data = bk.Measured.from_samples(
        *draw_direction_pairs(500, 1), model.eval(*draw_direction_pairs(500, 1)), channels=("Y",)
    )
    found = bk.fit(data, "lambert+ward", starts=1)
    bk.save(found, tmp_path / "fit.json")
    assert bk.load(tmp_path / "fit.json").values == found.values


def test_a_second_lobe_of_the_same_model_begins_narrower(model):
    """By about a third, seen from above, with all else alike: two alike are a saddle of the fit."""
    name = model.type_name()
    if name == "mixture" or all(lobe.diffuse for lobe in model().lobes()):
        pytest.skip("has several lobes, or none")
    both = labels.model(f"{name}+{name}")
    halves = []
    for number in (1, 2):
        own = f"{name}_{number}_specular_reflectance"
        alone = both(**{w: float(w == own) for w in both.weights()})
        theta = np.linspace(0, 1.3, 5000)
        values = alone.eval(np.tile([0, 0, 1.0], (5000, 1)), from_angles(theta, 0.0))[:, 0]
        halves.append(theta[np.argmax(values < values[0] / 2)])
    assert 0.25 < halves[1] / halves[0] < 0.4, halves
    same = [n for n, p in model.parameters.items() if not (p.linear or p.width or p.follows)]
    for parameter in same:
        assert both().values[f"{name}_2_{parameter}"] == both().values[f"{name}_1_{parameter}"]


def test_what_a_part_takes_from_the_geometry_is_no_search():
    data = bk.load("dusty_gold")
    angles = labels.model("pca_polynomial").determine_parameters(select_samples(data, 80.0))
    found = bk.fit(data, "pca_polynomial+ward", starts=1)
    for name, value in angles.items():
        assert found.values[f"pca_polynomial_1_{name}"] == value


@pytest.mark.quick
def test_a_sum_may_be_named_as_the_option_it_is():
    assert labels.model("mixture:models=ggx+ward") is labels.model("ggx+ward")


@pytest.mark.quick
@pytest.mark.parametrize(
    ("label", "words"),
    [
        ("ggx+nothing", ["'nothing'"]),
        ("ggx+lambert", ["lambert", "first"]),
        ("mixture:models=ggx", ["models = ggx", "two or more"]),
        ("mixture:models=", ["two or more"]),
        ("ggx+mixture:models=ward", ["models = ward", "two or more"]),
        ("ggx:colour=red", ["ggx", "'colour'"]),
        ("koenderink:order", ["'order'", "OPTION=VALUE"]),
        ("koenderink:order=99", ["order = 99", "0 or 1"]),
        ("koenderink:order=two", ["order = two"]),
    ],
)
def test_bad_labels_are_refused(label, words):
    with pytest.raises(BrdfkitError) as caught:
        labels.model(label)
    for word in words:
        assert word in str(caught.value)


@pytest.mark.quick
def test_options_reach_mitsuba(llvm_variant):
    mi = llvm_variant
    bsdf = mi.load_dict({"type": "mixture", "models": "lambert+ward", "ward_2_alpha_u": 0.3})
    assert "ward_2_alpha_u.value" in mi.traverse(bsdf)
    assert bsdf.component_count() == 2
    bsdf = mi.load_dict({"type": "koenderink", "order": 4, "a_4_4_4": 0.01})
    assert bsdf.component_count() == 1
