"""The background that only the camera sees, and the clipping box, in every renderer of volumes."""

import numpy as np
import pytest

from brdfkit.mitsuba_bridge.check_scenes import make_cube_camera
from brdfkit.rendering.volumes.scene import RENDERERS
from brdfkit.volumes import TransferFunction, Volume

SIGMA, GLOW, SKY, BACKGROUND = 2.0, 0.25, 0.5, np.array([0.9, 0.6, 0.3])
PLACE = [[0.25, 0, 0, 0.125], [0, 0.25, 0, 0.125], [0, 0, 0.25, 0.125], [0, 0, 0, 1]]


def render_cube(mi, renderer, background=None, **clip):
    """Render a homogeneous, glowing unit cube under an even sky: (8, 8, 3), x to the right."""
    values = np.ones((4, 4, 4), np.float32)
    function = TransferFunction([0, 2], np.tile([GLOW] * 3 + [1], (2, 1)), SIGMA, "emission")
    volume = Volume(values, PLACE).scene_dict(function)
    entries = {"type": renderer, RENDERERS[renderer]: volume | clip}
    if renderer == "single_scattering":
        entries["albedo"] = 0.0
    if background is not None:
        entries["background"] = {"type": "rgb", "value": list(background)}
    scene = {
        "type": "scene",
        "integrator": entries,
        "sensor": make_cube_camera(),
        "sky": {"type": "constant", "radiance": {"type": "rgb", "value": SKY}},
    }
    return np.array(mi.render(mi.load_dict(scene), spp=1024))


@pytest.mark.parametrize("renderer", RENDERERS)
def test_the_background_is_beside_the_clipped_half_and_lights_nothing(mi, renderer):
    whole = render_cube(mi, renderer, BACKGROUND)
    half = render_cube(mi, renderer, BACKGROUND, clip_high=[0.5, 1, 1])
    left_is_covered = abs(half[:, :4] - BACKGROUND).max() > 1e-3
    covered, free = (half[:, :4], half[:, 4:]) if left_is_covered else (half[:, 4:], half[:, :4])
    assert free == pytest.approx(np.broadcast_to(BACKGROUND, free.shape), abs=1e-4)
    assert covered.mean(axis=(0, 1)) == pytest.approx(whole.mean(axis=(0, 1)), rel=0.02)
    if renderer == "isosurface":  # white, and lit by the sky alone
        assert covered == pytest.approx(np.full(covered.shape, SKY), rel=0.05)


@pytest.mark.parametrize("renderer", RENDERERS)
def test_the_background_has_its_colour_in_a_spectral_variant(variant, renderer):
    import mitsuba as mi

    variant("llvm_ad_spectral")
    half = render_cube(mi, renderer, BACKGROUND, clip_high=[0.5, 1, 1])
    means = [side.mean(axis=(0, 1)) for side in (half[:, :4], half[:, 4:])]
    free = min(means, key=lambda mean: abs(mean - BACKGROUND).max())
    assert free == pytest.approx(BACKGROUND, rel=0.01)


@pytest.mark.parametrize("renderer", ["emission_absorption", "single_scattering"])
@pytest.mark.parametrize("depth", [1.0, 0.25])
def test_a_clipped_medium_is_as_thick_as_what_is_left(mi, renderer, depth):
    passed = np.exp(-SIGMA * depth)
    picture = render_cube(mi, renderer, BACKGROUND, clip_low=[0, 0, 1 - depth])
    expected = GLOW * (1 - passed) + passed * BACKGROUND
    assert picture.mean(axis=(0, 1)) == pytest.approx(expected, rel=0.01)


def test_the_face_of_a_clipped_surface_has_the_normal_of_the_box(mi):
    """Light along z leaves the face that looks at the camera as bright as light on a white wall."""
    values = Volume(np.ones((4, 4, 4), np.float32), PLACE)
    ramp = TransferFunction([0, 2], [[1, 1, 1, 0], [1, 1, 1, 1]])
    clipped = values.scene_dict(ramp) | {"clip_high": [1, 1, 0.4]}
    scene = {
        "type": "scene",
        "integrator": {"type": "isosurface", "volume": clipped, "level": 0.25},
        "sensor": make_cube_camera(),
        "sun": {"type": "directional", "direction": [0, 0, -1]},
    }
    picture = np.array(mi.render(mi.load_dict(scene), spp=4))
    assert picture == pytest.approx(np.full(picture.shape, 1 / np.pi), rel=1e-4)


@pytest.mark.parametrize(
    ("name", "numbers"),
    [
        ("volume.clip_high", [(1, high, 1) for high in (0.9, 0.7, 0.5)]),
        ("background", [(0, green, 1) for green in (0.9, 0.7, 0.5)]),
        ("level", [0.4, 0.5, 0.6]),
    ],
)
def test_new_numbers_need_no_new_kernel(mi, name, numbers):
    import drjit as dr

    values = Volume(np.ones((4, 4, 4), np.float32), PLACE).scene_dict("ct_bone")
    integrator = {"type": "isosurface", "volume": values, "background": 0.1}
    scene = mi.load_dict({"type": "scene", "integrator": integrator, "sensor": make_cube_camera()})
    parameters = mi.traverse(scene)
    with dr.scoped_set_flag(dr.JitFlag.KernelHistory, True):
        for number in numbers:
            dr.kernel_history_clear()
            parameters[f"integrator.{name}"] = number
            parameters.update()
            dr.eval(mi.render(scene, spp=1))
            new = [k for k in dr.kernel_history((dr.KernelType.JIT,)) if not k["cache_hit"]]
    assert not new
