"""Schlick's Fresnel reflectance with two colours, in every model that has it."""

import numpy as np
import pytest

import brdfkit as bk
from brdfkit.checks.material_subject import draw_direction_pairs
from brdfkit.core.errors import BrdfkitError
from brdfkit.model import labels
from brdfkit.model.fresnel import FresnelModel

NAMES = [name for name, model in bk.models().items() if issubclass(model, FresnelModel)]


@pytest.mark.quick
@pytest.mark.parametrize("name", NAMES)
def test_two_colours_of_one_f0_are_the_grey_form(name):
    """Channel by channel k₀ = k_s F₀ and k₉₀ = k_s, and so at the defaults."""
    pairs = draw_direction_pairs(1_000, seed=0)
    grey, coloured = labels.model(name), labels.model(f"{name}:fresnel=coloured")
    np.testing.assert_allclose(coloured().eval(*pairs), grey().eval(*pairs), rtol=1e-12)
    f0, k_s = np.array([0.9, 0.6, 0.04]), np.array([0.3, 0.2, 0.1])
    found = coloured(f0_reflectance=k_s * f0, f90_reflectance=k_s).eval(*pairs)
    channels = [grey(f0=a, specular_reflectance=b) for a, b in zip(f0, k_s, strict=True)]
    expected = np.concatenate([model.eval(*pairs) for model in channels], axis=1)
    np.testing.assert_allclose(found, expected, rtol=1e-12)


@pytest.mark.quick
def test_coupled_ashikhmin_shirley_has_the_rest_in_its_diffuse_weight():
    pairs = draw_direction_pairs(1_000, seed=0)
    grey = labels.model("ashikhmin_shirley:diffuse=coupled")
    coloured = labels.model("ashikhmin_shirley:diffuse=coupled,fresnel=coloured")
    expected = grey(diffuse_reflectance=0.5, specular_reflectance=0, f0=0.2).eval(*pairs)
    found = coloured(diffuse_reflectance=0.4, f0_reflectance=0, f90_reflectance=0).eval(*pairs)
    np.testing.assert_allclose(found, expected, rtol=1e-12)


def test_a_metals_colours_come_back():
    truth = labels.model("ggx:fresnel=coloured")(
        diffuse_reflectance=(0.01, 0.02, 0.03),
        alpha_u=0.25,
        f0_reflectance=(0.9, 0.6, 0.3),
        f90_reflectance=(0.8, 0.9, 1.0),
    )
    pairs = draw_direction_pairs(3_000, seed=1, max_degrees=80)
    data = bk.Measured.from_samples(*pairs, truth.eval(*pairs))
    found = bk.fit(data, "ggx:fresnel=coloured")
    assert found.loss < 1e-6
    for name, value in truth.values.items():
        np.testing.assert_allclose(found.values[name], value, rtol=1e-4, err_msg=name)
    assert bk.fit(data, "ggx").loss > 0.003


@pytest.mark.quick
def test_the_coloured_form_has_no_f0():
    coloured = labels.model("ggx:fresnel=coloured")
    assert coloured.weights() == ["diffuse_reflectance", "f0_reflectance", "f90_reflectance"]
    assert coloured.shapes() == ["alpha_u"]
    assert not hasattr(coloured(), "f0")
    with pytest.raises(BrdfkitError, match=r"no parameter 'f0'; there are .*f0_reflectance"):
        coloured(f0=0.1)
    assert labels.model("ggx:fresnel=coloured+ggx").shapes() == [
        "ggx_1_alpha_u",
        "ggx_2_alpha_u",
        "ggx_2_f0",
    ]
