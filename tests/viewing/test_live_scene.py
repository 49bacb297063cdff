"""The scenes of a view, beside scenes that were made for one state alone."""

import numpy as np
import pytest

import brdfkit as bk
from brdfkit.rendering.progressive import to_rgb
from brdfkit.rendering.scenes._studio import make_camera
from brdfkit.rendering.volumes.scene import describe_integrator
from brdfkit.viewing.camera import Camera
from brdfkit.viewing.volumes.application import VolumeApplication
from brdfkit.viewing.volumes.live_volume import VALUE_ROWS, LiveVolume
from brdfkit.viewing.volumes.pointer import find_visible_voxel
from brdfkit.viewing.volumes.saving import to_function
from brdfkit.viewing.volumes.volume_controls import LABELS
from brdfkit.volumes import Volume

LABEL_NUMBERS = np.array([0, 7, 1000, 1001, 3_000_000])
SMOOTH = np.sum(np.indices((6, 6, 6)), axis=0) ** 1.3


def make_volumes():
    """Volumes with ranges of values that a table does not suit by itself."""
    labels = LABEL_NUMBERS[np.random.default_rng(5).integers(0, 5, (6, 6, 6))]
    tilt = np.array([[1, 0.2, 0, 3], [-0.2, 1, 0.1, 1], [0, 0.1, 2, 0], [0, 0, 0, 1]])
    return {
        "labels": Volume(labels, name="labels", labels=True),
        "one label": Volume(np.full((2, 2, 2), 3), name="one", labels=True),
        "odd range": Volume(0.3 + SMOOTH / 7, name="odd"),
        "one value": Volume(np.full((2, 2, 2), 0.7), name="even"),
        "oblique": Volume(SMOOTH, tilt, "oblique"),
    }


@pytest.mark.parametrize("name", list(make_volumes()))
@pytest.mark.parametrize("renderer", ["maximum_intensity", "emission_absorption"])
def test_a_view_shows_what_a_scene_of_its_function_shows(mi, name, renderer):
    volume = make_volumes()[name]
    application = VolumeApplication(volume)
    state = application.change(
        application.first_state(), {"renderer": renderer, "background": "#000000"}
    )
    shown = application.render(state, 0, (32, 32), False, 7)

    function = application.states.functions.load(state["transfer.preset"], renderer)
    entries = describe_integrator(volume, function, renderer, {})
    camera = application.states.camera(state)
    sensor = make_camera((0, -1, 0), (0, 0, 0), camera.horizontal_fov(1.0), (32, 32))
    sensor |= {"to_world": mi.ScalarTransform4f(camera.to_world)}
    scene = mi.load_dict({"type": "scene", "integrator": entries, "sensor": sensor})
    expected = to_rgb(mi.render(scene, spp=1, seed=7))
    assert expected.max() > 0.05
    assert np.abs(shown - expected).max() < 0.02 * expected.max()


def test_each_label_has_its_row():
    volume = LiveVolume(make_volumes()["labels"])
    rows = np.rint(volume.to_shares(LABEL_NUMBERS) * (VALUE_ROWS - 1)).astype(int)
    assert volume.row_values[rows].tolist() == LABEL_NUMBERS.tolist()


def find_voxel(values, a, clip=((0, 0, 0), (1, 1, 1)), largest=False):
    """The y of the voxel in the middle of the picture from -y; A is a function of the values."""
    live = LiveVolume(Volume(values, np.eye(4), "made"))
    camera = Camera(0.0, 0.0, 60.0, 20.0, (3.5, 3.5, 3.5))
    alpha = a(live.row_values, live.row_gradients[:, None])
    table = np.repeat(np.atleast_2d(alpha)[..., None], 4, axis=-1)
    middle = np.array([0.5, 0.5])
    at = find_visible_voxel(live, camera, middle, 1.0, clip, table, 10.0, largest)
    return None if at is None else at[1]


def test_the_pointer_finds_what_the_picture_shows():
    walls = np.zeros((8, 8, 8))
    walls[:, 2, :] = walls[:, 6, :] = 1.0  # across the ray

    def opaque(values, gradients):
        return (values > 0.5) + 0 * gradients

    assert find_voxel(walls, opaque) == 2
    assert find_voxel(walls, opaque, [[0, 0.5, 0], [1, 1, 1]]) == 6
    assert find_voxel(walls, opaque, [[0, 0.7, 0], [1, 0.75, 1]]) is None
    # Maximum intensity shows the largest value, though its opacity is that of others
    walls[:, 6, :] = 2.0
    assert find_voxel(walls, opaque, largest=True) == 6
    # A function of gradients leaves the inside of a wide wall transparent, and its front opaque
    wide = np.zeros((8, 8, 8))
    wide[:, 3:] = 1.0
    assert find_voxel(wide, lambda v, g: (g > 0.3) * (v > 0.2)) in (2, 3)
    assert find_voxel(wide, lambda v, g: (g < 0.01) * (v > 0.9)) >= 4


def test_a_saved_function_is_the_one_that_was_shown(mi, tmp_path):
    """A function that is loaded again gives the same table, though another one has its name."""
    application = VolumeApplication(bk.volumes.load("smoke", size=8))
    states = application.states
    state = states.change(
        states.first(), {"transfer.points": [[0, "#ff0000", 0], [1, "#00ff00", 1]]}
    )
    path = tmp_path / "default.json"
    to_function(application, state).save(path)
    states.functions.add(path)
    loaded = states.change(states.first(), {"transfer.preset": path.name})
    # The colours of points have 8 bits
    assert states.functions.table(loaded) == pytest.approx(states.functions.table(state), abs=0.01)
    assert states.functions.load("default") is states.functions.load("default")


@pytest.mark.parametrize("renderer", list(LABELS))
def test_the_light_turns_without_its_map_being_sent_again(mi, renderer):
    application = VolumeApplication(bk.volumes.load("smoke", size=8))
    state = application.change(application.first_state(), {"renderer": renderer})
    application.render(state, 0, (32, 32), False, 0)
    (scene,) = application.scenes.kept.values()
    data = scene.parameters["sky.data"].array if "sky.data" in scene.parameters else None
    application.render(application.change(state, {"light.turn": 60}), 0, (32, 32), False, 0)
    assert data is None or scene.parameters["sky.data"].array.index == data.index


def test_no_scene_is_loaded_in_parallel(mi, monkeypatch):
    """Of each such scene Mitsuba kept 0.3 MB, as benchmarks/view_memory.py showed."""
    application = VolumeApplication(bk.volumes.load("smoke", size=8))
    how, load_dict = [], mi.load_dict

    def load(described, parallel=True):
        how.append(parallel and described["type"] == "scene")
        return load_dict(described, parallel=parallel)

    monkeypatch.setattr(mi, "load_dict", load)
    application.render(application.first_state(), 0, (32, 32), False, 0)
    assert how
    assert not any(how)


def test_the_default_function_suits_the_renderer(mi):
    states = VolumeApplication(bk.volumes.load("smoke", size=8)).states
    first = states.first()
    shown = states.change(first, {"renderer": "maximum_intensity"})
    function = states.functions.load("intensity")
    assert states.functions.table(shown) == pytest.approx(
        function(states.live.row_values), abs=0.02
    )
    assert states.change(shown, {"renderer": "single_scattering"}) == first
    # Right of the wipe, too; but a function that was drawn stays on both sides
    both = states.change(first, {"second": "maximum_intensity"})
    assert np.array_equal(
        states.functions.table(states.of_side(both, 1)), states.functions.table(shown)
    )
    drawn = {"transfer.points": [[0, "#000000", 0], [1, "#ffffff", 1]]}
    both = states.change(both, drawn)
    assert np.array_equal(
        states.functions.table(states.of_side(both, 1)), states.functions.table(both)
    )
    assert (
        states.change(both, {"renderer": "isosurface"})["transfer.points"]
        == drawn["transfer.points"]
    )


@pytest.mark.parametrize(
    "values",
    [
        np.float32(101325) + np.linspace(0, 2, 27, dtype=np.float32),
        np.float32(1000) + np.linspace(0, 0.01, 27, dtype=np.float32),
        np.full(27, 1e20),
        np.full(27, 2**63, np.uint64),
    ],
)
def test_any_range_of_values_has_a_histogram(mi, values):
    application = VolumeApplication(Volume(values.reshape(3, 3, 3), name="narrow"))
    message, _ = application.describe()
    assert sum(message["histogram"]) == 27
    low, high = message["volume"]["range"]
    assert low < high


def test_a_saved_function_keeps_narrow_bumps(mi):
    application = VolumeApplication(bk.volumes.load("smoke", size=8))
    states = application.states
    bump = {"x": 0.513, "y": 0.5, "sx": 0.001, "sy": 1, "colour": "#ffffff", "a": 0.9}
    state = states.change(states.first(), {"transfer.mode": "bumps", "transfer.bumps": [bump]})
    saved = to_function(application, state)
    assert saved(states.live.row_values) == pytest.approx(states.functions.table(state), abs=0.03)
