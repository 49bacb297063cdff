"""Live materials, beside previews and renderings of the same materials; their kernels counted."""

import numpy as np
import pytest
from helpers.random_models import at

import brdfkit as bk
from brdfkit.model.labels import model as find_model
from brdfkit.rendering.progressive import derive_seed
from brdfkit.viewing.materials.live_light import LiveLights
from brdfkit.viewing.materials.live_material import LiveMaterial
from brdfkit.viewing.materials.material_scene import Look, SceneKind, make_studio_camera

SIZE = (32, 32)
MOVING, RESTING = (SceneKind("ball", "studio", SIZE, moving) for moving in (True, False))
STUDIO = Look(make_studio_camera())
COLOURED = {"diffuse_reflectance": [0.4, 0.2, 0.1], "specular_reflectance": [0.2, 0.3, 0.1]}


@pytest.fixture(scope="module")
def lights(module_in_llvm):
    """The lights that all tests of a file share, since to filter one takes seconds."""
    return LiveLights()


def make_materials():
    """A measured material, and models with equal and with unequal widths."""
    ward = bk.models()["ward"]
    return {
        "measured": bk.load("car_paint"),
        "isotropic": ward(**COLOURED),
        "anisotropic": ward(**COLOURED, alpha_u=0.4, alpha_v=0.1),
        "signed": bk.models()["koenderink"](a_1_1_1=[0.1, 0.2, 0.3]),
        "spectral": ward(wavelengths=[450, 550, 650], diffuse_reflectance=[0.1, 0.2, 0.4]),
        "matte": bk.models()["lambert"](diffuse_reflectance=[0.4, 0.2, 0.1]),
    }


@pytest.mark.parametrize("name", list(make_materials()))
def test_pictures_are_those_of_preview_and_render(lights, name):
    material = make_materials()[name]
    live = LiveMaterial(material, lights)
    (expected,) = bk.preview(material, size=SIZE).pictures.values()
    assert live.render(MOVING, STUDIO) == pytest.approx(expected, abs=2e-4)

    kind = SceneKind("ball", "studio", SIZE, moving=False, ground=True)
    rendering = bk.render(material, size=SIZE, spp=1, seed=3, environment="studio")
    (expected,) = rendering.pictures.values()
    traced = live.render(kind, STUDIO, derive_seed(3, 0))
    # Single pixels may take another path, by rounding
    assert np.quantile(np.abs(traced - expected), 0.99) < 1e-3
    assert traced.mean() == pytest.approx(expected.mean(), rel=1e-3)


@pytest.mark.parametrize("label", [*bk.models(), "lambert+ward", "oren_nayar+ggx"])
def test_no_parameter_needs_a_new_kernel(lights, label):
    """Nor does a value on its bound; the first changes may compile what all others use."""
    model = find_model(label)
    live = LiveMaterial(model(), lights)
    changes = list(list_changes(model))
    for change in changes[:2]:
        assert count_new_kernels(live, change) >= 0
    slow = [change for change in changes[2:] if count_new_kernels(live, change)]
    assert slow == []


def list_changes(model):
    """Values of each parameter in turn: both bounds, and one between, with unequal channels."""
    for name, parameter in model.parameters.items():
        low, high = (-1.0, 1.0) if parameter.bounds[0] < 0 else (0.0, 1.0)
        if not parameter.linear:
            low, high = parameter.bounds
        for share in (0.3, 1.0, 0.0):
            value = at(share, low, high, parameter.log)
            yield {name: [value, 0.5 * value, 0.9 * value] if parameter.linear else value}


def count_new_kernels(live, change):
    """The number of kernels that are compiled to show a change, moving and at rest."""
    import drjit as dr

    with dr.scoped_set_flag(dr.JitFlag.KernelHistory, True):
        dr.kernel_history_clear()
        live.show(live.material.changed(**change))
        for kind in (MOVING, RESTING):
            live.render(kind, STUDIO)
        return sum(not k["cache_hit"] for k in dr.kernel_history((dr.KernelType.JIT,)))
