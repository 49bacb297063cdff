"""Live materials, beside previews and renderings of the same materials; their kernels counted."""

import time
from dataclasses import replace

import numpy as np
import pytest
from helpers.random_models import at

import brdfkit as bk
from brdfkit.model.labels import model as find_model
from brdfkit.rendering.progressive import derive_seed
from brdfkit.rendering.scenes._studio import BALL, TARGET
from brdfkit.viewing.materials.live_light import LAMP, PICTURES_BEFORE, LiveLights
from brdfkit.viewing.materials.live_material import LiveMaterial
from brdfkit.viewing.materials.material_scene import PLANE, Look, SceneKind, make_studio_camera

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
        count_new_kernels(live, change)
    slow = [change for change in changes[2:] if count_new_kernels(live, change)]
    assert slow == []


def test_turning_the_light_is_turning_the_camera(lights):
    """The ball is the same from all sides; the filtered map stays as it was filtered."""
    live = LiveMaterial(make_materials()["anisotropic"], lights)
    expected = live.render(MOVING, STUDIO)
    filtered = lights.get("studio").noise_free.light.lobes
    camera = replace(STUDIO.camera, azimuth=50.0)
    for turn in (10.0, 20.0):
        count_new_kernels(live, {}, Look(camera, turn))
    assert count_new_kernels(live, {}, Look(camera, turn=35.0)) == 0
    turned = live.render(MOVING, Look(camera, turn=50.0))
    assert turned == pytest.approx(expected, abs=2e-3)
    assert lights.get("studio").noise_free.light.lobes is filtered
    expected = np.mean([live.render(RESTING, STUDIO, s) for s in range(64)], axis=0)
    turned = np.mean([live.render(RESTING, Look(camera, 50.0), s) for s in range(64)], axis=0)
    assert turned.mean() == pytest.approx(expected.mean(), rel=0.01)


def test_the_light_is_filtered_beside_the_first_pictures(lights):
    """In a thread of its own; it may turn meanwhile."""
    material, own = make_materials()["measured"], LiveLights()
    live = LiveMaterial(material, own)
    turned = replace(STUDIO, turn=30.0)
    for seed in range(PICTURES_BEFORE):
        assert not own.get("studio").is_filtered
        live.render(RESTING, STUDIO, seed)
    end = time.monotonic() + 60
    while not own.get("studio").is_filtered and time.monotonic() < end:
        live.render(RESTING, turned)
    assert own.get("studio").noise_free.light.source is None  # nobody has waited for it
    expected = LiveMaterial(material, lights).render(MOVING, turned)
    assert live.render(MOVING, turned) == pytest.approx(expected, abs=2e-3)
    assert own.get("studio").is_filtered


def test_a_lamp_lights_the_plane(lights):
    """Its illuminance follows from the inverse square law; the picture is without noise."""
    live = LiveMaterial(bk.models()["lambert"](diffuse_reflectance=[0.4, 0.2, 0.1]), lights)
    above = Look(replace(STUDIO.camera, elevation=89.9), lamp=(0.0, 0.0, 3.0))
    kind = SceneKind(PLANE, LAMP, SIZE, moving=True)
    shown = live.render(kind, above)
    illuminance = (3.0 - BALL[2]) ** 2 / (3.0 - TARGET[2]) ** 2
    expected = np.array([0.4, 0.2, 0.1]) / np.pi * illuminance
    assert shown[16, 16] == pytest.approx(expected, rel=0.01)
    assert np.array_equal(live.render(kind, above, seed=5), shown)
    traced = live.render(replace(kind, moving=False), above)
    assert traced[12:20, 12:20].mean() == pytest.approx(shown[12:20, 12:20].mean(), rel=0.01)

    live.render(kind, replace(above, lamp=(1.0, 0.0, 3.0)))
    assert count_new_kernels(live, {}, replace(above, lamp=(2.0, 1.0, 3.0)), [kind]) == 0
    assert live.render(kind, replace(above, lamp=(2.0, 1.0, 3.0)))[16, 16, 0] < shown[16, 16, 0]


def test_a_mesh_is_shown_from_both_sides(lights, tmp_path):
    """Also after the same material on a ball, which has no back."""
    mesh = tmp_path / "tent.obj"
    mesh.write_text("v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv 0 1 0\nf 1 2 5\nf 3 4 5\n")
    material = bk.models()["ward"](**COLOURED, alpha_u=0.31)
    (expected,) = bk.preview(material, size=SIZE, scene=f"{mesh}#y").pictures.values()
    live = LiveMaterial(material, lights)
    live.render(MOVING, STUDIO)
    kind = replace(MOVING, shape=f"{mesh}#y")
    assert live.render(kind, STUDIO) == pytest.approx(expected, abs=2e-4)
    for change in ({"alpha_u": 0.1}, {"alpha_v": 0.4}):
        count_new_kernels(live, change, kinds=[kind])
    assert count_new_kernels(live, {"diffuse_reflectance": 0.0}, kinds=[kind]) == 0


def test_a_probe_of_the_user_lights_the_plane():
    grey = {"grey": np.full((16, 32, 3), 7.0)}  # the ground's illuminance becomes 1
    live = LiveMaterial(bk.models()["lambert"](diffuse_reflectance=0.5), LiveLights(grey))
    shown = live.render(SceneKind(PLANE, "grey", SIZE, moving=True), STUDIO)
    assert shown[16, 16] == pytest.approx([0.5 / np.pi] * 3, rel=0.01)


def test_only_values_of_the_same_model_are_shown(lights):
    models = bk.models()
    live = LiveMaterial(models["ward"](), lights)
    assert not live.show(models["ward"]())
    assert live.show(models["ward"](alpha_u=0.3))
    assert live.material == models["ward"](alpha_u=0.3)
    for other in (models["ggx"](), bk.load("car_paint")):
        with pytest.raises(bk.BrdfkitError, match="is another material than ward"):
            live.show(other)


def list_changes(model):
    """Values of each parameter in turn: both bounds, and one between, with unequal channels."""
    for name, parameter in model.parameters.items():
        low, high = (-1.0, 1.0) if parameter.bounds[0] < 0 else (0.0, 1.0)
        if not parameter.linear:
            low, high = parameter.bounds
        for share in (0.3, 1.0, 0.0):
            value = at(share, low, high, parameter.log)
            yield {name: [value, 0.5 * value, 0.9 * value] if parameter.linear else value}


def count_new_kernels(live, change, look=STUDIO, kinds=(MOVING, RESTING)):
    """The number of kernels that are compiled to show a change, moving and at rest."""
    import drjit as dr

    with dr.scoped_set_flag(dr.JitFlag.KernelHistory, True):
        dr.kernel_history_clear()
        live.show(live.material.changed(**change))
        for kind in kinds:
            live.render(kind, look)
        return sum(not k["cache_hit"] for k in dr.kernel_history((dr.KernelType.JIT,)))
