"""Values that are labels, such as numbers of tissues: a view shows them so when it is told."""

import json
import shlex

import numpy as np
import pytest

import brdfkit as bk
from brdfkit.rendering.progressive import derive_seed
from brdfkit.viewing.session import Session
from brdfkit.viewing.volumes.application import VolumeApplication
from brdfkit.viewing.volumes.source import Source

HELLO = {"type": "hello", "width": 64, "height": 64}
TISSUES = np.indices((8, 8, 8)).sum(0) // 4 * 5  # 0 to 25


@pytest.fixture
def session(mi):
    session = Session(VolumeApplication(bk.volumes.Volume(TISSUES.astype(np.uint8), name="atlas")))
    session.handle(HELLO)
    return session


def tell(session, **changes):
    return session.handle({"type": "set", "changes": changes})


def test_values_that_may_be_labels_are_a_notice(session):
    _, (notice, _) = session.handle(HELLO)
    assert notice["text"].startswith("atlas may hold labels, not densities: if so, tick")
    tell(session, labels=True)
    assert len(session.handle(HELLO)) == 1
    told = Source("atlas.nii", {"labels": False})
    assert VolumeApplication(session.application.loaded, told).doubts() == []
    assert VolumeApplication(bk.volumes.load("smoke", size=8)).doubts() == []


def test_the_values_become_labels_and_undo_takes_it_back(session):
    first = dict(session.state)
    tell(session, **{"camera.azimuth": 77.0})
    ((message, _),) = tell(session, labels=True)
    state = message["state"]
    assert (state["labels"], state["camera.azimuth"]) == (True, 77)
    assert state["transfer.mode"] == "preset"  # a colour for each label
    assert session.application.states.functions.load("default").name == "a colour for each label"
    assert "picture" in [message["type"] for message, _ in session.work()]
    for way, labels in (("undo", False), ("redo", True), ("reset", False)):
        session.handle({"type": way})
        assert session.application.volume.labels == session.state["labels"] == labels
        assert session.application.states.live.volume is session.application.volume
    assert session.state == first
    assert session.application.volume is session.application.loaded


def test_values_that_are_no_whole_numbers_stay_what_they_are(mi):
    session = Session(VolumeApplication(bk.volumes.load("smoke", size=8)))
    before = dict(session.state)
    (error, _), _ = tell(session, labels=True)
    assert "so they cannot be labels" in error["text"]
    assert session.state == before
    assert not session.application.volume.labels


def test_the_script_shows_labels(session):
    tell(session, labels=True, renderer="emission_absorption")
    ((message, _),) = session.handle({"type": "copy", "kind": "python"})
    names = {"volume": session.application.loaded}
    lines = message["text"].replace("spp=64", "spp=1").splitlines()[:-1]
    exec("\n".join(lines), names)
    (picture,) = names["picture"].pictures.values()
    expected = session.application.render(session.state, 0, (64, 64), False, derive_seed(0, 0))
    np.testing.assert_allclose(picture, expected, rtol=1e-5, atol=1e-6)


@pytest.mark.parametrize("option", ["--labels", "--no-labels"])
def test_the_command_says_what_the_values_are(session, option):
    source = Source("atlas.nii", {"labels": option == "--labels"})
    own = Session(VolumeApplication(session.application.loaded, source))
    ((message, _),) = own.handle({"type": "copy", "kind": "command"})
    words = shlex.split(message["text"])
    assert words[2:4] == ["atlas.nii", option]
    assert json.loads(words[5]) == {}
