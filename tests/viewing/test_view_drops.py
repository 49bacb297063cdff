"""Materials, fits and names that are opened on a page, from an empty one, too."""

import json
import tempfile

import pytest
import small_files

import brdfkit as bk
from brdfkit.core import catalogue
from brdfkit.viewing import empty, kinds
from brdfkit.viewing.choosing import make_application
from brdfkit.viewing.drops import DropSession
from brdfkit.viewing.materials.parameter_state import to_state
from brdfkit.viewing.volumes.application import VolumeApplication

HELLO = {"type": "hello", "width": 64, "height": 64, "state": None}


@pytest.fixture
def session(mi, tmp_path, monkeypatch):
    """A session of an empty page, whose uploads lie in a folder that is empty at the end."""
    folder = tmp_path / "uploads"
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    session = DropSession(make_application(None))
    session.handle(HELLO)
    yield session
    session.close()
    assert list(folder.iterdir()) == []


def drop(session, files):
    """Drop files, by name; return Python's answers by their types."""
    for index, (name, content) in enumerate(files.items()):
        piece = {"type": "upload", "name": name, "size": len(content), "offset": 0}
        answers = session.handle(piece | {"index": index, "count": len(files)}, content)
    return {message["type"]: message for message, _ in answers}


def test_an_empty_page_offers_names_and_renders_nothing(session):
    ((opened, _),) = session.handle(HELLO)
    offered = [name for _, things in opened["start"]["lists"] for name, _ in things]
    assert offered == empty.list_names()
    assert set(catalogue.list_materials()) < set(offered)
    while session.has_work():  # it loads what the first picture needs
        assert session.work() == []
    assert session.handle({"type": "probe", "x": 0.5, "y": 0.5}) == []
    for message in ({"type": "fit"}, {"type": "save", "kind": "png"}, {"type": "copy"}):
        assert session.handle(message)[0][0]["type"] == "error"


@pytest.mark.parametrize("name", ["car_paint", "ggx", "sphere"])
def test_a_name_of_the_list_takes_the_place_of_the_start(session, name):
    ((opened, _), *_) = session.handle({"type": "load", "name": name})
    assert (opened["title"], session.has_work()) == (name, True)
    assert opened["subject"] == make_application(name).subject


@pytest.mark.parametrize("name", ["/etc/passwd", "../car_paint", "x.py", "", None, ["ggx"], {}])
def test_no_other_name_is_opened(session, tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "x.py").write_text("raise AssertionError")
    (error, _), _ = session.handle({"type": "load", "name": name})
    assert "is no name of the list" in error["text"]
    assert session.application.name == "An empty page"


@pytest.mark.parametrize("kind", sorted({*small_files.FILES} - {"curet"}))
def test_a_measured_file_is_shown_beside_a_model(session, kind):
    name, content = small_files.FILES[kind]
    opened = drop(session, {f"some/folder/{name}": content})["open"]
    assert opened["state"]["renderer"] == "measured"
    assert session.application.name == opened["title"]
    assert session.application.file == name


def test_every_format_that_is_written_is_known_by_its_content(tmp_path):
    for kind, (name, content) in small_files.written().items():
        path = tmp_path / f"{kind}{name[5:]}"
        path.write_bytes(content)
        expected = kinds.FIT if "fit" in kind else kinds.MATERIAL
        assert kinds.find_kind(path) == expected, kind


def test_another_material_keeps_the_models_and_the_light(session):
    name, content = small_files.FILES["astm"]
    session.handle({"type": "load", "name": "ward"})
    changes = {"model.alpha_u": 0.3, "light.turn": 30, "shape": "plane", "second": ""}
    session.handle({"type": "set", "changes": changes})
    state = drop(session, {name: content})["open"]["state"]
    assert state == state | changes | {"model": "ward", "second": "model"}


def test_another_material_keeps_the_bonds_of_the_shown_model(session):
    name, content = small_files.FILES["astm"]
    session.handle({"type": "load", "name": "ggx"})
    key = "model.diffuse_reflectance"
    changes = {
        f"{key}.linked": False,
        f"{key}.R": 0.5,
        f"{key}.G": 0.1,
        "model.alpha_v.tied": False,
    }
    for one in changes:
        session.handle({"type": "set", "changes": {one: changes[one]}})
    state = drop(session, {name: content})["open"]["state"]
    assert state == state | changes


@pytest.mark.parametrize("beside", ["car_paint", "sphere", None])
def test_a_dropped_fit_is_shown(session, beside):
    """Beside the material that is shown, or alone."""
    if beside:
        session.handle({"type": "load", "name": beside})
    name, content = small_files.written()["fit_json, written"]
    drop(session, {name: content})
    state, fit = session.state, small_files.fit()
    assert state == state | to_state(fit.rgb)
    assert state["renderer"] == ("measured" if beside == "car_paint" else "model")


def test_a_copied_command_of_a_dropped_file_says_that_its_folder_is_hidden(session):
    name, content = small_files.FILES["astm"]
    drop(session, {name: content})
    for kind in ("python", "command"):
        ((message, _),) = session.handle({"type": "copy", "kind": kind})
        assert message["text"].startswith(f"# Write the folder of {name} before its name")
        assert name in message["text"].partition("\n")[2]


TWO = dict.fromkeys(["a.astm", "b.astm"], small_files.astm())


@pytest.mark.parametrize(
    ("files", "sentence"),
    [
        ({"a.binary": b"x" * 99}, "a.binary: "),
        ({"a.astm": b"VARS theta_i\n1"}, "a.astm: "),
        ({"a.csv": b"theta_i,theta_o\n1,2\n"}, "a.csv: "),
        ({"a.json": b'{"brdfkit": "1", "model": "x.py"}'}, "a.json: "),
        ({"a.pkl": b"\x80\x04cbuiltins\nexec\n"}, "is no file that the page opens"),
        ({"a.npz": b"PK\x03\x04"}, "a.npz: "),
        (TWO, "a.astm and b.astm are two materials; drop one of them."),
        (TWO | {"m.obj": b""}, "None of a.astm, b.astm and m.obj is used."),
    ],
    ids=str,
)
def test_a_file_that_cannot_be_shown_is_the_readers_sentence(session, files, sentence):
    answers = drop(session, files)
    assert sentence in answers["error"]["text"]
    assert "brdfkit-view" not in answers["error"]["text"]
    assert session.application.name == "An empty page"


def test_what_belongs_to_another_subject_says_what_to_open(session):
    text = json.dumps({"kind": "brdfkit transfer function"}).encode()
    assert "open one, and drop the file again" in drop(session, {"tf.json": text})["error"]["text"]
    session.exchange(VolumeApplication(bk.volumes.load("smoke", size=8)))
    answers = drop(session, {"a.obj": b"v 0 0 0\n"})
    assert "a mesh shows a material" in answers["error"]["text"]


def test_json_of_a_single_value_says_so(session):
    text = drop(session, {"a.json": b"null"})["error"]["text"]
    assert text == (
        "a.json: is neither a fit nor settings, nor a transfer function: its JSON is only null."
    )


def test_settings_with_a_wrong_value_say_which(session):
    session.handle({"type": "load", "name": "ggx"})
    before = dict(session.state)
    content = json.dumps({"tone.stops": 1.0, "light.turn": "round"}).encode()
    text = drop(session, {"a.json": content})["error"]["text"]
    assert text.startswith("a.json: all its settings are left aside, because one is wrong: ")
    assert "round" in text
    assert session.state == before


def test_json_of_no_use_beside_a_material_says_what_is(session):
    session.handle({"type": "load", "name": "ggx"})
    assert "is neither a fit nor settings" in drop(session, {"a.json": b"null"})["error"]["text"]


MESH = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 2 3 4\nf 1 3 4\n"


def test_a_mesh_on_an_empty_page_shows_a_model(session):
    answers = drop(session, {"a.obj": MESH})
    assert {"open", "state"} <= answers.keys()
    assert (session.state["shape"], session.application.name) == ("a.obj", "ggx")


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("a.obj", b"v 0 0\n"),
        ("a.ply", b"ply\nx"),
        ("a.exr", b"v/1\x01x"),
        ("a.hdr", b"#?RGBE\nFORMAT=32-bit"),
    ],
)
def test_what_was_opened_stays_if_a_file_beside_it_is_damaged(session, name, content):
    answers = drop(session, {"paint.astm": small_files.astm(), name: content})
    assert answers["error"]["text"].startswith(f"{name}: ")
    assert "brdfkit-view" not in answers["error"]["text"]
    assert not any(word in answers["error"]["text"] for word in (".cpp", "FileStream", "I/O"))
    assert "dictionary" not in answers["error"]["text"]
    assert answers["open"]["title"] == "paint"
    assert session.state["shape"] == "ball"
