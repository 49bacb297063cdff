"""A session of a material beside a model: its state, its fit, its files and its scripts."""

import io
import json
import shlex
import threading
import time

import numpy as np
import pytest
from click.testing import CliRunner
from PIL import Image
from scipy.ndimage import binary_dilation

import brdfkit as bk
from brdfkit.cli import main
from brdfkit.core.colours import from_srgb
from brdfkit.core.errors import BrdfkitError
from brdfkit.images.errors.colour_difference import ciede2000
from brdfkit.lighting.environments.map_files import read_map, write_map
from brdfkit.viewing import background
from brdfkit.viewing.choosing import is_volume, make_application
from brdfkit.viewing.materials import fit_task
from brdfkit.viewing.materials.application import MaterialApplication
from brdfkit.viewing.materials.beside import open_beside
from brdfkit.viewing.materials.parameter_state import to_state
from brdfkit.viewing.passes import CALM, mix_pictures
from brdfkit.viewing.picture_files import join_sides
from brdfkit.viewing.session import Session
from brdfkit.viewing.volumes.application import VolumeApplication

HELLO = {"type": "hello", "width": 64, "height": 64, "state": None}


@pytest.fixture(scope="module")
def application(module_in_llvm):
    """The view that all tests share, with its scenes."""
    # Without plots, so that each step of work is a pass of the picture
    return MaterialApplication("car_paint", ["ggx", "ward"], {"plots.show.polar": False})


@pytest.fixture
def session(application):
    application.states.fits.clear()
    own = Session(application)
    own.handle(HELLO)
    return own


def change(session, moving=False, **changes):
    """Change settings, "__" for a dot in their names; return the messages by their types."""
    named = {name.replace("__", "."): value for name, value in changes.items()}
    answers = session.handle({"type": "set", "changes": named, "moving": moving})
    return {message["type"]: message for message, _ in answers}


def pictures_of(session):
    """The sides of the pictures that the next pass sends; the page shows them."""
    messages = [message for message, _ in session.work() if message["type"] == "picture"]
    session.handle({"type": "shown", "number": session.number})
    return [message["side"] for message in messages]


def test_the_map_of_differences_is_that_of_the_colours_as_shown(session):
    change(session, compare="difference", tone__curve="reinhard")
    while not session.accumulated:
        pictures_of(session)
    session.stale = True
    described, (content,) = next(m for m in session.work() if m[0]["type"] == "difference")
    left, right = (from_srgb(session.sent[1][side] / 255) for side in (0, 1))
    differences = ciede2000(left, right)
    mask = session.application.find_mask(session.state, (64, 64))
    assert 0.2 < mask.mean() < 0.5  # the ball
    assert differences[~binary_dilation(mask, iterations=3)].max() == 0
    assert described["mean"] == pytest.approx(differences[mask].mean(), rel=1e-3)
    assert described["upper"] == pytest.approx(np.quantile(differences[mask], 0.95), rel=1e-3)
    drawn = np.asarray(Image.open(io.BytesIO(content))).astype(float).sum(axis=-1)
    assert np.corrcoef(drawn[mask], differences[mask])[0, 1] > 0.9
    session.handle({"type": "save", "kind": "png"})

    ((probe, _),) = session.handle({"type": "probe", "x": 0.5, "y": 0.5})
    assert probe["text"].endswith(f"ΔE {differences[32, 32]:.2g}")
    ((probe, _),) = session.handle({"type": "probe", "x": 0, "y": 0})
    assert probe["text"].endswith("ΔE 0")
    pictures = {side: samples.picture for side, samples in session.accumulated.items()}
    assert join_sides(pictures, session.state).shape == (64, 128, 3)


def test_the_pointer_and_the_pictures_name_what_is_shown(session):
    def describe():
        sent = [message for message, _ in session.work() if message["type"] == "picture"]
        session.handle({"type": "shown", "number": session.number})
        ((read, _),) = session.handle({"type": "probe", "x": 0.5, "y": 0.5})
        return [message["name"] for message in sent], read["text"]

    names, text = describe()
    assert (names, text.count("ggx: ")) == (["car_paint", "ggx"], 1)
    change(session, model="ward")
    ((read, _),) = session.handle({"type": "probe", "x": 0.5, "y": 0.5})
    assert read["text"] == text  # of the old picture still
    names, text = describe()
    assert (names, text.count("ward: ")) == (["car_paint", "ward"], 1)
    before = session.application.describe_side(session.state, 1)["needs"]
    for name, value in {"shape": "plane", "light.environment": "sky", "model": "ggx"}.items():
        state = session.application.change(session.state, {name: value})
        assert state[name] != before[name]


def test_the_lamp_and_the_view_move_without_a_new_scene(session):
    application = session.application

    def show(**changes):
        change(session, **changes)
        return application.render(session.state, 1, session.picture_size(True), True, 0)

    first = show(light__environment="lamp")
    mirrored = show(light__lamp_azimuth=54)
    assert mirrored[:, ::-1] == pytest.approx(first, abs=0.01 * float(first.max()))
    x, y, seen = application.overlay(session.state, (64, 64))["lamp"]
    row, column = np.unravel_index(mirrored.sum(axis=2).argmax(), mirrored.shape[:2])
    assert seen
    assert 0.5 < column / 32 < x  # half-way to the lamp
    assert y < row / 32 < 0.5
    scenes = len(application.live.kept["ggx"].scenes.kept)
    behind = show(view__azimuth=180)
    assert application.overlay(session.state, (64, 64))["lamp"][2] is False
    assert behind.mean() < 0.6 * first.mean()
    assert len(application.live.kept["ggx"].scenes.kept) == scenes


def test_a_mesh_and_a_map_are_shown_beside_the_others(session, tmp_path):
    mesh, probe = tmp_path / "tent.obj", tmp_path / "grey.exr"
    mesh.write_text("v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv 0 1 0\nf 1 2 5\nf 3 4 5\n")
    write_map(np.full((16, 32, 3), 7.0), probe)
    for path, kind in ((mesh, "mesh"), (probe, "environment")):
        open_beside(session.application, session, kind, path)
        path.rename(path.with_name(f"kept_{path.name}"))  # as the page's own are deleted
    assert (session.state["shape"], session.state["light.environment"]) == ("tent.obj", "grey.exr")
    session.work()
    lit = session.accumulated[1].picture
    mask = session.application.find_mask(session.state, (64, 64))
    assert (lit[mask] > 0).all()  # from both sides
    shapes = next(c for c in session.application.describe()[0]["controls"] if c["name"] == "shape")
    assert ["tent.obj#z", "tent.obj, z up"] in shapes["choices"]
    files = {
        "shape": str(mesh.with_name("kept_tent.obj")) + "#y",
        "light.environment": str(probe.with_name("kept_grey.exr")),
    }
    again = MaterialApplication("car_paint", ["ggx"], files)
    assert again.first["shape"] == "kept_tent.obj#y"
    session.application.states.scenery.close()


def fit(session):
    """Fit the model that is shown; return the messages by their types."""
    answers = session.handle({"type": "fit"})
    while session.tasks:
        answers += session.work()
    return {message["type"]: message for message, _ in answers}


def test_the_material_is_left_and_the_model_right_in_the_same_light(session):
    session.work()
    change(session, model__alpha_u=0.05)
    session.work()
    first = {side: samples.picture for side, samples in session.accumulated.items()}
    change(session, model__alpha_u=0.6)
    session.work()
    second = {side: samples.picture for side, samples in session.accumulated.items()}
    assert first[0] == pytest.approx(second[0], abs=1e-6)  # sums of threads are rounded
    assert np.abs(first[1] - second[1]).mean() > 1e-3
    change(session, renderer="model")
    session.work()
    left, right = (session.accumulated[side].picture for side in (0, 1))
    assert left == pytest.approx(right, abs=1e-6)
    session.handle({"type": "pin"})
    change(session, renderer="pin1", model__alpha_u=0.05)
    session.work()
    pinned, right = (session.accumulated[side].picture for side in (0, 1))
    assert pinned == pytest.approx(left, abs=1e-6)
    assert right == pytest.approx(first[1], abs=1e-6)


def test_a_moving_slider_renders_only_the_model(session, monkeypatch):
    change(session, moving=True, model__alpha_u=0.3)
    before = session.work()
    assert [m["side"] for m, _ in before if m["type"] == "picture"] == [0, 1]
    monkeypatch.delattr(type(session.application.live.kept[""]), "render")
    state = session.state | {"model.alpha_u": 0.4}
    session.application.render(state, 0, session.picture_size(True), True, 0)
    with pytest.raises(AttributeError, match="render"):
        session.application.render(state, 1, session.picture_size(True), True, 0)


def test_the_picture_stays_calm_after_a_move(session):
    """The noise of the first passes was seen in place of the picture without noise."""
    while not session.previews:  # the kernels for moves are made at rest
        pictures_of(session)
    change(session, moving=True, model__alpha_u=0.3)
    assert pictures_of(session) == [0, 1]
    change(session, model__alpha_u=0.31)
    assert (pictures_of(session), session.passes) == ([0, 1], 0)
    calm = session.previews
    assert calm[1].shape == (64, 64, 3)  # of the resolution at rest
    shares = []
    while session.passes < 12:
        session.work()
        shown = mix_pictures(session.accumulated, session.previews)
        traced = session.accumulated[1].picture - calm[1]
        shares.append(((shown[1] - calm[1]) * traced).sum() / (traced**2).sum())
    noises = [samples.noise for samples in session.accumulated.values()]
    assert shares[0] == 0
    assert shares[-1] == pytest.approx(CALM / max(noises), rel=1e-3)
    assert 0 < shares[1] < shares[-1] < 1


@pytest.mark.parametrize("label", ["ward", "ggx+ward", "koenderink", "lafortune:lobe_count=2"])
def test_another_model_brings_its_own_controls(session, label):
    answers = change(session, model=label)
    names = {name for name in session.state if name.startswith("model.")}
    controls = {c["name"] for c in answers["controls"]["controls"]}
    assert names == {name for name in controls if name.startswith("model.")}
    assert answers["controls"]["state"] == session.state
    kind = session.application.states.find_class(session.state)
    assert session.state == session.state | to_state(kind().rgb)
    back = session.handle({"type": "undo"})
    assert [m["type"] for m, _ in back] == ["state", "controls", "fit"]
    assert session.state == session.first


def test_a_whole_state_is_taken_over_with_its_values(session):
    """Links and colours must not change the values beside them."""
    change(session, model="ward + ggx")
    change(session, model__ward_1_specular_reflectance__linked=False)
    change(session, model__ward_1_specular_reflectance__R=7.5)
    change(session, model__ggx_2_alpha_v=0.05, light__turn=30)
    state = dict(session.state)
    other = Session(session.application.again())
    other.handle(HELLO | {"state": json.loads(json.dumps(state))})
    assert other.state == state
    other.handle({"type": "reset"})
    assert other.state == other.first


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"model": "gxx"}, "did you mean ggx"),
        ({"model": ["ggx"]}, "a name such as ggx"),
        ({"model": "open('a').py"}, "no model"),
        ({"model.alpha_u": "wide"}, "a number from"),
        ({"model.f0.R": 1}, "no setting"),
        ({"light.environment": "/etc/passwd"}, "choose one of"),
    ],
)
def test_an_impossible_setting_is_a_sentence(session, changes, sentence):
    before = session.state
    (message, _), _ = session.handle({"type": "set", "changes": changes})
    assert (message["type"], sentence in message["text"]) == ("error", True), message
    assert session.state == before


def test_a_fit_moves_the_sliders_and_is_compared(session):
    answers = fit(session)
    expected = bk.fit("car_paint", "ggx")
    assert session.state == session.state | to_state(expected.rgb)
    value, error = answers["fit"]["marks"]["model.alpha_u"]
    assert (value, error) == (expected.values["alpha_u"], expected.standard_errors["alpha_u"])
    weights = [answers["fit"]["marks"][f"model.specular_reflectance.{c}"][0] for c in "RGB"]
    assert weights == list(expected.values["specular_reflectance"])
    defaults = {c["name"]: c["default"] for c in answers["controls"]["controls"]}
    assert defaults["model.alpha_u"] == value
    assert answers["busy"]["text"] == ""

    losses = [name for name, _, _ in answers["errors"]["columns"]]
    row, floor = answers["errors"]["rows"]
    errors = bk.compare("car_paint", expected).errors["ggx"]
    assert row["cells"] == [f"{errors[name]:.3g}" for name in losses]  # none is small
    assert all(
        float(low) < float(own) for low, own in zip(floor["cells"], row["cells"], strict=True)
    )

    change(session, model="ward")
    answers = fit(session)
    assert [row["name"] for row in answers["errors"]["rows"]][:2] == ["ggx", "ward"]
    change(session, model="ggx")  # which has its fitted values still
    assert session.state["model.alpha_u"] == value
    session.handle({"type": "undo"})
    assert session.state["model"] == "ward"


def test_a_fit_can_be_cancelled_and_fails_in_a_sentence(session, monkeypatch):
    before, application = dict(session.state), session.application

    def fit_for_ever(*_, progress, **__):
        for step in range(10**9):
            progress(step, 10**9)

    monkeypatch.setattr(fit_task, "fit", fit_for_ever)
    session.handle({"type": "fit"})
    texts = [message.get("text") for _ in range(8) for message, _ in session.work()]
    assert "Fitting ggx …" in texts
    ((again, _), *_) = session.handle({"type": "fit"})
    assert "goes on already" in again["text"]
    session.handle({"type": "cancel"})
    end = time.monotonic() + 10
    while background.NAME in [thread.name for thread in threading.enumerate()]:
        assert time.monotonic() < end
        time.sleep(0.01)
    assert session.tasks == []
    assert (session.state, application.states.fits) == (before, {})

    monkeypatch.setattr(fit_task, "fit", lambda *_, **__: bk.fit("car_paint", "ggx", loss="no"))
    answers = fit(session)
    assert "no loss 'no'" in answers["error"]["text"]
    assert not session.paused


def test_parameters_that_do_nothing_are_named_with_the_picture(session):
    change(session, model__specular_reflectance__R=0.0)
    overlay = session.application.overlay(session.state, (64, 64))
    assert overlay["idle"].keys() == {"model.alpha_u", "model.alpha_v", "model.f0"}


def test_the_copied_command_and_script_repeat_the_picture(session, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    change(session, model__alpha_u=0.4, wipe=0.25, light__turn=40)
    while session.passes < 2:
        session.work()
    ((_, (content,)),) = session.handle({"type": "save", "kind": "exr"})
    (tmp_path / "page.exr").write_bytes(content)
    ((message, _),) = session.handle({"type": "copy", "kind": "command"})
    words = shlex.split(message["text"].replace("--spp 64", "--spp 2").replace(".png", ".exr"))
    assert CliRunner().invoke(main, words[1:]).exit_code == 0
    ((message, _),) = session.handle({"type": "copy", "kind": "python"})
    text = message["text"].replace("spp=64", "spp=2").replace("car_paint.png", "script.exr")
    exec(compile(text, "script", "exec"), {})
    expected = read_map(tmp_path / "page.exr")
    for name in ("car_paint.exr", "script.exr"):
        np.testing.assert_allclose(read_map(tmp_path / name), expected, rtol=1e-4, atol=1e-5)


@pytest.mark.parametrize("label", ["ggx+ward", "lafortune:lobe_count=2"])
def test_the_script_makes_the_model_as_it_is(session, label):
    change(session, model=label)
    ((message, _),) = session.handle({"type": "copy", "kind": "python"})
    (line,) = [line for line in message["text"].splitlines() if line.startswith("model = ")]
    made = {"brdfkit": bk}
    exec(line, made)
    assert made["model"] == session.application.states.to_model(session.state)


def test_a_fit_is_saved_and_opened_again(session, tmp_path):
    ((message, _), *_) = session.handle({"type": "save", "kind": "fit"})
    assert "choose Fit first" in message["text"]
    fit(session)
    ((message, (content,)),) = session.handle({"type": "save", "kind": "fit"})
    path = tmp_path / message["name"]
    path.write_bytes(content)
    assert path.name == "car_paint-ggx.json"
    beside = make_application("car_paint", [path])
    assert beside.first == beside.first | to_state(bk.load(path).rgb)
    assert beside.follow({}, beside.first)[1][0]["marks"]
    alone = make_application(path)
    assert (alone.sides(alone.first), alone.first["renderer"]) == (1, "model")
    ((message, _), *_) = Session(alone).handle({"type": "fit"})
    assert "was not measured" in message["text"]


@pytest.mark.quick
@pytest.mark.parametrize(
    ("thing", "volume"), [("smoke", True), ("a.nii", True), ("ggx", False), ("a.binary", False)]
)
def test_what_is_viewed_is_known_by_its_name(thing, volume):
    assert is_volume(thing) == volume


def test_a_name_of_nothing_is_refused_with_the_nearest(tmp_path):
    assert isinstance(make_application("smoke", size=8), VolumeApplication)
    for name, nearest in {"smok": "smoke", "car_paimt": "car_paint", "gx": "ggx"}.items():
        with pytest.raises(BrdfkitError, match=f"did you mean {nearest}"):
            make_application(name)
    with pytest.raises(BrdfkitError, match="viewed without models"):
        make_application("smoke", ["ggx"])
    with pytest.raises(BrdfkitError, match="is no model"):
        make_application("car_paint", ["plaster"])
    with pytest.raises(BrdfkitError, match="--downsample"):
        make_application("car_paint", downsample=2)
