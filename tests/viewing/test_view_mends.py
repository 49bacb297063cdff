"""A file whose azimuths are mirrored: its audit, and the view that mends it."""

import shlex
import time
from unittest import mock

import numpy as np
import pytest
import small_files
from click.testing import CliRunner
from mirrored_samples import mirrored_samples

import brdfkit as bk
from brdfkit.cli import main
from brdfkit.cli.commands import view
from brdfkit.core.errors import BrdfkitError
from brdfkit.viewing.choosing import make_application
from brdfkit.viewing.drops import DropSession
from brdfkit.viewing.materials.application import MaterialApplication

HELLO = {"type": "hello", "width": 64, "height": 64, "state": None}
MIRROR = {"mend.mirror_azimuth": True}


@pytest.fixture(scope="module")
def mirrored():
    return mirrored_samples()


@pytest.fixture
def session(mi, mirrored):
    own = DropSession(MaterialApplication(mirrored))
    own.handle(HELLO)
    return own


def audit(session):
    """The message of an audit, which is computed beside the pictures."""
    assert session.handle({"type": "audit"}) == []
    end = time.monotonic() + 30
    while not session.ready and time.monotonic() < end:
        time.sleep(0.01)
    ((message, _),) = session.work()
    return message


def change(session, **changes):
    named = {name.replace("__", "."): value for name, value in changes.items()}
    answers = session.handle({"type": "set", "changes": named, "moving": False})
    return {message["type"]: message for message, _ in answers}


def find_choices(answers, name):
    (control,) = (c for c in answers["controls"]["controls"] if c["name"] == name)
    return [value for value, _ in control["choices"]]


def test_a_mirrored_file_is_told_and_mended_by_one_change(session, mirrored):
    message = audit(session)
    assert message["file"][0].startswith("192 samples, ")
    (finding,) = (f for f in message["findings"] if f["mend"])
    assert (finding["mend"], finding["title"]) == (*MIRROR, "Highlight towards the light")
    assert "φo = φi + 180°" in finding["text"]
    assert "mirror_azimuth" not in finding["text"]

    states = session.application.states
    answers = change(session, mend__mirror_azimuth=True)  # by its box or its button
    assert session.state["second"] == "file"
    assert find_choices(answers, "second") == ["", "measured", "file", "model"]
    np.testing.assert_array_equal(states.measured.samples.wo, mirrored.samples.wo * [-1, -1, 1])
    shown = [
        states.find_side(session.state, session.state[side])[1] for side in ("renderer", "second")
    ]
    assert shown == [states.measured, mirrored]
    message = audit(session)
    assert [f for f in message["findings"] if f["mend"]] == []
    assert any("Mended: φo was counted" in line for line in message["file"])

    session.handle({"type": "undo"})
    assert (session.state, states.measured) == (session.first, mirrored)


def test_the_file_is_no_side_after_its_mend_is_taken_back(session):
    (error, *_) = session.handle({"type": "set", "changes": {"second": "file"}})
    assert "is not possible" in error[0]["text"]
    change(session, mend__mirror_azimuth=True, second="file")
    answers = change(session, mend__mirror_azimuth=False)
    assert (session.state["second"], find_choices(answers, "second")[2]) == ("model", "model")


def test_a_mend_leaves_what_is_asked_for_beside_it(session):
    change(session, mend__mirror_azimuth=True, second="model")
    assert session.state["second"] == "model"
    assert make_application(session.application.given[0], [], MIRROR).first["second"] == "model"


def test_each_mend_has_fits_of_its_own(session):
    states, fit = session.application.states, small_files.fit()
    states.keep_fit("ward", fit)
    change(session, mend__mirror_azimuth=True, second="file")
    assert states.fits == {}
    session.handle({"type": "fit"})
    assert session.state["second"] == "model"  # so that the fit is seen
    session.handle({"type": "cancel"})
    change(session, mend__mirror_azimuth=False)
    assert states.fits == {"ward": fit}


@pytest.mark.parametrize("sides", [{}, {"second": "file"}], ids=str)
def test_what_is_copied_mends_the_file(mirrored, tmp_path, monkeypatch, sides):
    monkeypatch.chdir(tmp_path)
    bk.save(mirrored, "mirrored.npz")
    session = DropSession(make_application("mirrored.npz", [], MIRROR | sides))
    texts = {}
    for kind in ("python", "command"):
        ((message, _),) = session.handle({"type": "copy", "kind": kind})
        texts[kind] = message["text"]
    made = []
    monkeypatch.setattr(
        "brdfkit.viewing.render_view", lambda *given, **_: made.append(given) or mock.Mock()
    )
    assert "brdfkit.load('mirrored.npz', mirror_azimuth=True)\n" in texts["python"]
    exec(compile(texts["python"], "script", "exec"), {})
    monkeypatch.setattr(view, "_write_picture", lambda make, *_: made.append(make().given[::2]))
    assert CliRunner().invoke(main, shlex.split(texts["command"])[1:]).exit_code == 0
    expected = session.application.states
    for material, state in made:
        again = make_application(material, [], state)
        for side in ("renderer", "second"):
            _, shown = again.states.find_side(again.first, again.first[side])
            _, own = expected.find_side(session.state, session.state[side])
            assert getattr(shown, "info", None) == getattr(own, "info", None)
    assert len(made) == 2


def test_what_cannot_be_mended_says_why(session):
    for thing, sentence in {"car_paint": "is a table", "ggx": "A model is never mended"}.items():
        with pytest.raises(BrdfkitError, match=sentence):
            make_application(thing, [], MIRROR)
    (error, *_) = session.handle({"type": "set", "changes": {"mend.all": True}})
    assert "no setting 'mend.all'" in error[0]["text"]
    for words in (["smoke", "--mirror-azimuth"], ["--mirror-azimuth"]):
        assert CliRunner().invoke(main, ["view", *words]).exit_code == 2
    alone = DropSession(make_application("ggx"))
    assert "nothing to audit" in alone.handle({"type": "audit"})[0][0]["text"]
