"""The controls of all models' parameters, their links and ties, and which do nothing."""

import numpy as np
import pytest
from helpers.random_models import random_model

import brdfkit as bk
from brdfkit.lighting.filtering.scene_bsdfs import PAIRS
from brdfkit.model.labels import model as find_model
from brdfkit.viewing.materials.idle_parameters import find_idle_parameters
from brdfkit.viewing.materials.parameter_controls import list_panels, make_controls
from brdfkit.viewing.materials.parameter_groups import (
    find_affected_lobes,
    group_parameters,
    place_between_bounds,
)
from brdfkit.viewing.materials.parameter_state import change_values, to_model, to_state

pytestmark = pytest.mark.quick


def test_every_parameter_has_controls_on_one_panel(configured):
    model = random_model(configured, 3, full_bounds=True)
    controls, state = make_controls(model), to_state(model)
    assert {control.name: control.check(control.default) for control in controls} == state
    assert len(controls) == len(state)
    groups = group_parameters(configured)
    named = [name for group in groups for name in (*group.weights, *group.shapes)]
    assert sorted(named) == sorted(configured.parameters)
    panels = [name for name, _, _ in list_panels(configured)]
    assert list(dict.fromkeys(control.panel for control in controls)) == panels
    assert len({label for _, label, _ in list_panels(configured)}) == len(groups)


def test_the_state_keeps_a_model_exactly(configured):
    model = random_model(configured, 5, full_bounds=True)
    assert to_model(configured, to_state(model)) == model


@pytest.mark.parametrize("black", [0, 1])
def test_idle_parameters_are_those_that_change_nothing(model, black):
    """The weight of one lobe is 0."""
    shown = random_model(model, 7)
    names = model.weights()
    shown = shown.changed(**{names[black % len(names)]: 0.0})
    before, useless = shown.eval(*PAIRS), set()
    for name, parameter in model.parameters.items():
        moved = 0.01 if parameter.linear else place_between_bounds(parameter, 0.4)
        after = shown.changed(
            **{name: np.add(getattr(shown, name), moved)} if parameter.linear else {name: moved}
        )
        if np.array_equal(after.eval(*PAIRS), before):
            useless.add(name)
    assert set(find_idle_parameters(shown)) == useless


def test_idle_parameters_have_reasons():
    ggx = bk.models()["ggx"]
    assert find_idle_parameters(ggx()) == {"alpha_v": "It equals α_u: the material is isotropic."}
    assert find_idle_parameters(ggx(specular_reflectance=0.0, alpha_v=0.1)) == dict.fromkeys(
        ("alpha_u", "alpha_v", "f0"), "k_s is 0."
    )
    coupled = find_model("ashikhmin_shirley:diffuse=coupled")(f0=1.0, exponent_v=3.0)
    assert list(find_idle_parameters(coupled)) == ["diffuse_reflectance"]


def test_lobes_know_their_parameters():
    affected = find_affected_lobes(find_model("oren_nayar+ggx"))
    assert {name: lobes.tolist() for name, lobes in affected.items()} == {
        "oren_nayar_1_sigma": [True, False, False],
        "ggx_2_alpha_u": [False, True, False],
        "ggx_2_alpha_v": [False, True, False],
        "ggx_2_f0": [False, True, False],
    }
    affected = find_affected_lobes(find_model("disney"))  # the last: terms without a weight
    assert affected["roughness"].tolist() == [True, True]
    assert affected["clearcoat"].tolist() == [False, True]
    labels = [label for _, label, _ in list_panels(find_model("ggx+ward"))]
    assert labels == ["Diffuse term", "Highlight 1", "Highlight 2"]


def test_controls_say_what_the_model_declares():
    controls = {c.name: c for c in make_controls(bk.models()["torrance_sparrow"]())}
    alpha = controls["model.alpha"]
    assert (alpha.label, alpha.unit, alpha.log) == ("m", "rad", True)
    assert (alpha.low, alpha.high, alpha.default) == (0.001, 1.0, 0.2)
    assert alpha.help == "Rms inclination of the facets."
    assert controls["model.specular_reflectance.R"].high == 1.0
    controls = {c.name: c for c in make_controls(bk.models()["disney"](base_color=0.9))}
    assert controls["model.base_color.R"].high == 1.0
    abc = bk.models()["abc"](specular_reflectance=[300.0, 20.0, 1.0])
    assert {c.name: c for c in make_controls(abc)}["model.specular_reflectance.B"].high == 1000.0


def test_links_and_ties():
    ggx = bk.models()["ggx"]
    state = to_state(ggx(specular_reflectance=[0.4, 0.2, 0.1]))
    weight = "model.specular_reflectance"
    linked = change_values(ggx, state, {f"{weight}.G": 0.3})
    assert to_model(ggx, linked).specular_reflectance == pytest.approx((0.6, 0.3, 0.15))
    assert linked[f"{weight}.colour"] == state[f"{weight}.colour"]

    apart = change_values(ggx, state, {f"{weight}.linked": False})
    apart = change_values(ggx, apart, {f"{weight}.G": 0.3})
    assert to_model(ggx, apart).specular_reflectance == (0.4, 0.3, 0.1)

    red = change_values(ggx, state, {f"{weight}.colour": "#ff0000"})
    assert to_model(ggx, red).specular_reflectance == (0.4, 0.0, 0.0)
    black = change_values(ggx, red, {f"{weight}.R": 0.0})
    again = change_values(ggx, black, {f"{weight}.R": 0.7})
    assert to_model(ggx, again).specular_reflectance == (0.7, 0.0, 0.0)

    assert to_model(ggx, change_values(ggx, state, {"model.alpha_u": 0.5})).alpha_v == 0.5
    untied = change_values(ggx, state, {"model.alpha_v": 0.1})
    moved = change_values(ggx, untied, {"model.alpha_u": 0.5})
    assert to_model(ggx, moved).alpha_v == 0.1
    tied = change_values(ggx, moved, {"model.alpha_v.tied": True})
    assert to_model(ggx, tied).alpha_v == 0.5
