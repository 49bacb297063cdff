"""Pictures of volumes: what is seen from where, behind what, in what light; limits and errors."""

from math import exp

import numpy as np
import pytest

from brdfkit import BrdfkitError, render, render_volume, volumes
from brdfkit.rendering.tracing import _estimate_passes_within_time
from brdfkit.rendering.volumes import defaults
from brdfkit.rendering.volumes.scene import RENDERERS, UNLIT, describe_integrator
from brdfkit.volumes import TransferFunction, Volume

pytestmark = pytest.mark.usefixtures("module_in_llvm")
RNG = np.random.default_rng(15)
WHITE = TransferFunction([0, 1], [[1, 1, 1, 0], [1, 1, 1, 1]], 50, name="white")


def seen(volume, renderer="maximum_intensity", spp=1, size=32, **how):
    """The picture alone (height, width, 3)."""
    found = render_volume(volume, renderer=renderer, spp=spp, size=size, **how)
    return found.pictures[found.reference]


def dot(axes, *where):
    """A volume with one bright voxel: `where` along x, y, z, 0 to 4."""
    values = np.full((5, 5, 5), 0.2)
    values[where[::-1]] = 1
    return Volume(values, np.diag([1, 1, 1, 1]), axes=axes)


@pytest.mark.parametrize(
    ("axes", "azimuth", "where", "upper", "left"),
    [
        ("RAS", 0, (4, 4, 4), True, True),  # from the front, the patient's right is on our left
        ("RAS", 0, (0, 4, 0), False, False),
        ("RAS", 90, (0, 4, 4), True, True),  # from the patient's left, the front is on our left
        ("RAS", 180, (4, 0, 4), True, False),
        ("", 0, (4, 0, 4), True, False),  # from -y, as x, z of a chart
        ("", 90, (4, 4, 0), False, False),  # from +x
    ],
)
def test_the_world_is_seen_from_where_it_is_said(axes, azimuth, where, upper, left):
    grey = TransferFunction.from_colormap("gray", (0, 1), opacity=[(0, 1), (1, 1)])
    view = {"transfer": grey, "azimuth": azimuth, "elevation": 0}
    picture = seen(dot(axes, *where), **view)[..., 0]
    y, x = np.unravel_index(picture.argmax(), picture.shape)
    assert (y < 12, y > 20, x < 12, x > 20) == (upper, not upper, left, not left)


@pytest.mark.parametrize("size", [(48, 48), (60, 30), (30, 60)])
@pytest.mark.parametrize("view", [(30, 15), (200, -80), (90, 90)])
def test_all_that_shows_is_in_the_picture(size, view):
    """A narrow block in a corner of an oblique grid fills the picture, and is not cut."""
    values = np.zeros((16, 12, 10))
    values[1:7, 2:4, 5:9] = 1
    oblique = RNG.normal(size=(3, 3)) @ np.diag([1, 2, 3])
    to_world = np.block([[oblique, np.array([[50], [-7], [9]])], [np.zeros(3), 1]])
    look = {"transfer": WHITE, "background": 0, "azimuth": view[0], "elevation": view[1]}
    block = Volume(values, to_world)
    shown = seen(block, "emission_absorption", size=size, **look)[..., 0] > 0.5
    rows, columns = np.flatnonzero(shown.any(axis=1)), np.flatnonzero(shown.any(axis=0))
    for found, n in ((rows, size[1]), (columns, size[0])):
        assert found[0] > 0
        assert found[-1] < n - 1
    filled = max(np.ptp(rows) / size[1], np.ptp(columns) / size[0])
    assert 0.6 < filled < 1


def test_the_light_of_a_known_block():
    """Through the middle of a cube of edge 2: RGB (1 - exp(-σ d)) + exp(-σ d) behind."""
    cube = Volume(np.full((4, 4, 4), 3.0), np.diag([0.5, 0.5, 0.5, 1]))
    rgb = [0.8, 0.4, 0.2]
    glow = TransferFunction([0, 3], [[*rgb, 1], [*rgb, 1]], 0.6, "emission")
    look = {"azimuth": 0, "elevation": 0, "density": 2, "background": (0, 0.5, 1)}
    for renderer in ("emission_absorption", "single_scattering"):
        more = {} if renderer == "emission_absorption" else {"settings": {"albedo": 0}}
        picture = seen(cube, renderer, 64, transfer=glow, **look, **more)[16, 16]
        through = exp(-0.6 * 2 * 2)
        expected = (1 - through) * np.array(rgb) + through * np.array([0, 0.5, 1])
        noise = 0 if renderer == "emission_absorption" else 0.15  # 4 of (0.09 of 1 - 0.09) / 64
        np.testing.assert_allclose(picture, expected, rtol=2e-3, atol=noise)


@pytest.mark.parametrize("renderer", RENDERERS)
def test_behind_a_volume_is_the_background(renderer):
    """The corners of the picture see nothing else, however bright the environment is there."""
    picture = seen(volumes.load("sphere", size=16), renderer, background=0.07)
    corners = picture[[0, 0, -1, -1], [0, -1, 0, -1]]
    np.testing.assert_allclose(corners, 0.07, rtol=1e-3)
    assert np.isfinite(picture).all()
    assert picture[16, 16].max() > 0.1


def test_the_background_among_the_settings_is_the_one_that_shows():
    settings = {"background": 0.07}
    picture = seen("sphere", "emission_absorption", settings=settings)
    np.testing.assert_allclose(picture[0, 0], 0.07, rtol=1e-3)


def test_the_environment_shows_without_a_background():
    light = {"azimuth": 0, "elevation": 0, "spp": 16, "environment": "sky"}
    around = seen("sphere", "isosurface", background=None, **light)
    plain = seen("sphere", "isosurface", background=0.02, **light)
    assert around[0, 0, 1] > 5 * plain[0, 0, 1]
    np.testing.assert_allclose(around[16, 16], plain[16, 16], rtol=0.2)  # lit from all sides else


def test_a_volume_of_any_unit_is_as_dense():
    """Where no unit is known, the extinction goes with the size."""
    values = RNG.random((8, 8, 8))
    pictures = [
        seen(Volume(values, np.diag([s, s, s, 1])), "emission_absorption") for s in (1, 1e-3, 1e5)
    ]
    for picture in pictures[1:]:
        np.testing.assert_allclose(picture, pictures[0], rtol=1e-3, atol=1e-3)


# The look that is chosen for a volume


@pytest.mark.parametrize(
    ("values", "settings", "name"),
    [
        ([-1000, 0, 1500], {"axes": "RAS"}, "ct_bone"),
        ([0, 90, 255], {"axes": "RAS"}, "mri_head"),
        ([0, 90, 255], {}, "RdYlBu_r"),
        ([0, 1, 29], {"labels": True, "axes": "RAS"}, "a colour for each label"),
    ],
)
def test_the_default_look_depends_on_the_data(values, settings, name):
    volume = Volume(np.reshape(values, (1, 1, 3)), **settings)
    assert defaults.choose_transfer_function(volume, "single_scattering").name == name


def test_labels_have_colours_and_0_has_none():
    labels = Volume(np.arange(30).reshape(2, 3, 5), labels=True)
    rgba = defaults.choose_transfer_function(labels, "single_scattering")(np.arange(30))
    assert rgba[0, 3] == 0
    assert (rgba[1:, 3] == 1).all()
    assert all((rgba[i, :3] != rgba[i + 1, :3]).any() for i in range(1, 29))


def test_labels_of_atlases_have_colours_of_their_own():
    """Also those that are far apart, as in the atlases of FreeSurfer and Allen."""
    given = [0, 1, 2, 12175, 614454277]
    labels = Volume(np.reshape(given, (1, 1, 5)), labels=True)
    picture = seen(labels, "emission_absorption", transfer=_one_colour_each(given), azimuth=0)
    row = picture[16].round(2)
    for k in range(1, len(given)):
        assert (row == round(0.1 * k, 2)).all(axis=1).any(), k


def _one_colour_each(labels):
    k = np.arange(len(labels))
    rgba = np.column_stack([0.1 * k, 0.1 * k, 0.1 * k, k > 0])
    return TransferFunction(labels, rgba, 100.0, "emission")


def test_the_level_parts_the_values_best():
    """Otsu's, by trying all thresholds."""
    values = np.concatenate([RNG.normal(0, 1, 700), RNG.normal(7, 2, 300)])

    def between(t):
        low, high = values[values <= t], values[values > t]
        return len(low) * len(high) * (low.mean() - high.mean()) ** 2

    best = max(np.linspace(values.min() + 0.01, values.max() - 0.01, 500), key=between)
    found = defaults.choose_surface_level(Volume(values.reshape(10, 10, 10)))
    assert between(found) == pytest.approx(between(best), rel=1e-3)


def test_a_surface_is_of_any_material():
    coal = {"bsdf": {"type": "diffuse", "reflectance": 0.0}}
    black = seen("sphere", "isosurface", 4, settings=coal)
    assert black[16, 16].max() < 1e-6
    by_name = describe_integrator(
        volumes.load("sphere", size=4), None, "isosurface", {"bsdf": "lambert"}
    )
    assert by_name["bsdf"]["type"] == "lambert"


# Limits, and what is wrong


def test_samples_are_added_for_so_long():
    found = render_volume("sphere", renderer="maximum_intensity", size=16, seconds=1e-3)
    assert found.spp == found.requested == 4
    assert found.standard_error is None
    assert _estimate_passes_within_time(10, seconds=2, done=4) == 20
    assert _estimate_passes_within_time(2.5, seconds=2, done=1) == 2  # the first one compiles
    assert _estimate_passes_within_time(1, seconds=2, done=4) == 4


def test_ctrl_c_keeps_the_passes():
    def stop(done, total):
        if done == 2:
            raise KeyboardInterrupt

    found = render_volume("sphere", size=32, spp=64, progress=stop)
    assert (found.spp, found.requested) == (8, 64)
    assert found.standard_error.shape == (32, 32, 3)
    assert found.parameters["sphere"]["renderer"] == "single_scattering"


@pytest.mark.parametrize(
    ("how", "message"),
    [
        ({"renderer": "isosurfac"}, "did you mean isosurface?"),
        ({"transfer": "ct_bon"}, "did you mean ct_bone?"),
        ({"background": (1, -1, 0)}, "at least 0"),
        ({"density": 0}, "density = 0 should be a number above 0"),
        ({"seconds": "1"}, "seconds"),
        ({"azimuth": np.nan}, "azimuth"),
        ({"density": 1e9}, "check the unit of length"),
        (
            {"settings": {"stepz": 3}, "renderer": "emission_absorption"},
            "'stepz'; did you mean steps?",
        ),
        ({"settings": {"phase": "hgg"}}, "hgg"),
    ],
)
def test_what_is_wrong_is_said(how, message):
    with pytest.raises(BrdfkitError, match=message.replace("?", r"\?")) as raised:
        render_volume("sphere", size=8, spp=1, **how)
    assert "\n" not in str(raised.value)


def test_render_says_where_volumes_belong():
    with pytest.raises(BrdfkitError, match="call render_volume"):
        render(volumes.load("sphere", size=4))


@pytest.mark.parametrize("renderer", UNLIT)
def test_what_has_no_light_but_its_own_needs_few_samples(renderer):
    """Those that it has by default leave noise that is hardly seen, 45 dB."""
    found, many = (
        render_volume("smoke", renderer=renderer, size=64, spp=spp, seed=seed)
        for spp, seed in ((None, 0), (64, 1))
    )
    assert found.spp == 8
    apart = [np.clip(one.pictures["smoke"], 0, 1) for one in (found, many)]
    assert 10 * np.log10(1 / np.mean((apart[0] - apart[1]) ** 2)) > 45


def test_a_callback_sees_the_picture_that_grows():
    """It asks where it has a parameter for it; the last one is the result."""
    seen_so_far, numbers = [], []

    def show(done, total, pictures):
        seen_so_far.append(pictures()["sphere"])

    found = render_volume("sphere", size=16, spp=16, progress=show)
    assert len(seen_so_far) == 4
    np.testing.assert_array_equal(seen_so_far[-1], found.pictures["sphere"])
    errors = [np.abs(p - seen_so_far[-1]).mean() for p in seen_so_far]
    assert errors[0] > errors[2] > 0
    render_volume("sphere", size=16, spp=8, progress=lambda *given: numbers.append(given))
    assert numbers == [(1, 2), (2, 2)]
