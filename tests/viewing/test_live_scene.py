"""The scenes of a view, beside scenes that were made for one state alone."""

import numpy as np
import pytest

import brdfkit as bk
from brdfkit.rendering.progressive import to_rgb
from brdfkit.rendering.scenes._studio import make_camera
from brdfkit.rendering.volumes.scene import describe_integrator
from brdfkit.viewing.volumes import slices
from brdfkit.viewing.volumes.application import VolumeApplication
from brdfkit.viewing.volumes.live_volume import LiveVolume
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

    function = application.states.load_preset(state["transfer.preset"])
    entries = describe_integrator(volume, function, renderer, {})
    camera = application.states.camera(state)
    sensor = make_camera((0, -1, 0), (0, 0, 0), camera.horizontal_fov(1.0), (32, 32))
    sensor |= {"to_world": mi.ScalarTransform4f(camera.to_world)}
    scene = mi.load_dict({"type": "scene", "integrator": entries, "sensor": sensor})
    expected = to_rgb(mi.render(scene, spp=1, seed=7))
    assert expected.max() > 0.05
    assert np.abs(shown - expected).max() < 0.02 * expected.max()


def test_each_label_has_its_colour():
    volume = LiveVolume(make_volumes()["labels"])
    assert volume.row_values[volume.find_rows(LABEL_NUMBERS)].tolist() == LABEL_NUMBERS.tolist()


def test_the_pointer_finds_what_the_clipping_box_leaves():
    values = np.zeros((8, 8, 8))
    values[:, 2, :] = values[:, 6, :] = 1.0  # two walls across the ray
    volume = LiveVolume(Volume(values, np.eye(4), "walls"))
    extinction = 10.0 * (volume.row_values > 0.5)
    ray = np.array([3.5, -50.0, 3.5]), np.array([0.0, 1.0, 0.0])
    whole, half = [[0, 0, 0], [1, 1, 1]], [[0, 0.5, 0], [1, 1, 1]]
    assert slices.find_visible_voxel(volume, extinction, whole, ray)[1] == 2
    assert slices.find_visible_voxel(volume, extinction, half, ray)[1] == 6
    assert slices.find_visible_voxel(volume, extinction, [[0, 0.7, 0], [1, 0.75, 1]], ray) is None


def test_a_saved_function_is_the_one_that_was_shown(mi, tmp_path):
    """A function that is loaded again gives the same table, though another one has its name."""
    application = VolumeApplication(bk.volumes.load("smoke", size=8))
    states = application.states
    state = states.change(
        states.first(), {"transfer.points": [[0, "#ff0000", 0], [1, "#00ff00", 1]]}
    )
    path = tmp_path / "default.json"
    to_function(application, state).save(path)
    states.add_function(path)
    loaded = states.change(states.first(), {"transfer.preset": path.name})
    # The colours of points have 8 bits
    assert states.table(loaded) == pytest.approx(states.table(state), abs=0.01)
    assert states.load_preset("default") is states.function


@pytest.mark.parametrize("renderer", list(LABELS))
def test_the_light_turns_without_its_map_being_sent_again(mi, renderer):
    application = VolumeApplication(bk.volumes.load("smoke", size=8))
    state = application.change(application.first_state(), {"renderer": renderer})
    application.render(state, 0, (32, 32), False, 0)
    (scene,) = application.scenes.values()
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
