"""The state machine behind a page: messages in, messages out, without a browser."""

import io
import json
import threading
import time
import zipfile

import drjit as dr
import numpy as np
import pytest
from PIL import Image

import brdfkit as bk
from brdfkit.core.errors import BrdfkitError
from brdfkit.viewing import picture_files
from brdfkit.viewing import picture_loop as loop_file
from brdfkit.viewing.drops import DropSession
from brdfkit.viewing.render_thread import work_safely
from brdfkit.viewing.session import Session
from brdfkit.viewing.volumes import histograms, saving
from brdfkit.viewing.volumes.application import VolumeApplication
from brdfkit.viewing.volumes.volume_controls import LABELS


@pytest.fixture(scope="module")
def volume():
    return bk.volumes.load("smoke", size=16)


@pytest.fixture(scope="module")
def application(mi, volume):
    return VolumeApplication(volume, "smoke")


@pytest.fixture
def session(application):
    session = DropSession(application)
    session.handle({"type": "hello", "width": 64, "height": 64, "state": None})
    return session


BUMP = {"x": 0.5, "y": 0.5, "sx": 0.1, "sy": 0.1, "colour": "#ffffff", "a": 1}


def work(session):
    """Let the session render once, and confirm its pictures."""
    messages = session.work()
    for message, _ in messages:
        if message["type"] == "picture":
            session.handle({"type": "shown", "number": message["number"]})
    return messages


def work_first_passes(session):
    """Render the passes that come before all else."""
    for _ in range(loop_file.FIRST_PASSES):
        work(session)


def kinds(messages):
    return [message["type"] for message, _ in messages]


def test_the_first_message_has_all_that_the_page_needs(session):
    ((message, (joint,)),) = session.handle({"type": "hello", "width": 64, "height": 64})
    assert json.loads(json.dumps(message))["type"] == "open"
    names = {control["name"] for control in message["controls"]}
    assert names <= set(message["state"])
    assert {control["panel"] for control in message["controls"]} <= {
        panel["name"] for panel in message["panels"]
    }
    assert sum(message["histogram"]) == 16**3
    assert joint.startswith(b"\x89PNG")


def test_a_move_is_small_and_a_rest_converges(session):
    moving = session.handle({"type": "set", "changes": {"camera.azimuth": 50}, "moving": True})
    assert moving == []
    ((picture, (content,)), _) = work(session)
    assert picture["mime"] == "image/jpeg"
    assert Image.open(io.BytesIO(content)).size == (32, 32)
    assert not session.has_work()
    (state,) = session.handle({"type": "set", "changes": {"camera.azimuth": 51}, "moving": False})
    assert state[0]["state"]["camera.azimuth"] == 51
    samples = [work(session)[-1][0]["samples"] for _ in range(3)]
    assert samples == [1, 2, 3]
    assert "noise" in session.describe_progress()[0]["noise"]


def test_no_picture_is_sent_before_the_last_one_is_shown(session):
    session.handle({"type": "set", "changes": {"camera.azimuth": 1}, "moving": True})
    ((picture, _), _) = session.work()
    session.handle({"type": "set", "changes": {"camera.azimuth": 2}, "moving": True})
    assert not session.has_work()
    session.handle({"type": "shown", "number": picture["number"]})
    assert session.has_work()


def test_nothing_is_rendered_while_nobody_looks(session):
    session.handle({"type": "visible", "visible": False})
    assert not session.has_work()
    session.handle({"type": "visible", "visible": True})
    assert session.has_work()
    work(session)
    session.handle({"type": "pause", "paused": True})
    assert not session.has_work()


def test_undo_and_redo_skip_what_was_dragged_over(session):
    for azimuth in (40, 50, 60):
        session.handle({"type": "set", "changes": {"camera.azimuth": azimuth}, "moving": True})
    session.handle({"type": "set", "changes": {"camera.azimuth": 70}, "moving": False})
    ((undone, _),) = session.handle({"type": "undo"})
    assert (undone["state"]["camera.azimuth"], undone["can_undo"]) == (30, False)
    ((redone, _),) = session.handle({"type": "redo"})
    assert redone["state"]["camera.azimuth"] == 70
    session.handle({"type": "reset"})
    assert session.state == session.application.first_state()


def test_the_address_has_settings_of_one_volume(session):
    """After a dropped file, those of another one were applied to the volume of the command."""
    hello = {"type": "hello", "width": 64, "height": 64}
    ((opened, _),) = session.handle(hello)
    assert opened["subject"] == "smoke of 16×16×16 voxels"
    changed = {"camera.azimuth": 77.0}
    other = changed | {"subject": "head of 4×5×6 voxels", "transfer.preset": "head.json"}
    (opened, _), (error, _) = session.handle(hello | {"state": other})
    assert opened["state"] == session.first
    assert error["text"].startswith("The address has settings of head of 4×5×6 voxels; they are")
    for own in (changed, changed | {"subject": opened["subject"]}):
        session.handle({"type": "reset"})
        ((opened, _),) = session.handle(hello | {"state": own})
        assert opened["state"]["camera.azimuth"] == 77


@pytest.mark.parametrize(
    ("state", "says"),
    [
        ("damaged", "The address is damaged"),
        ({"camera.fov": "x", "camera.azimuth": 9.0}, "All settings of the address are left aside"),
    ],
)
def test_an_address_that_cannot_be_shown_is_said(session, state, says):
    _, (error, _) = session.handle({"type": "hello", "width": 64, "height": 64, "state": state})
    assert error["text"].startswith(says)
    assert session.state == session.first


def test_what_changes_no_sample_keeps_the_samples(session):
    work(session), work(session)
    session.handle({"type": "set", "changes": {"tone.stops": 1.5, "wipe": 0.2}, "moving": False})
    assert work(session)[-1][0]["samples"] == 2


@pytest.mark.parametrize(
    "changes",
    [
        {"nonsense": 1},
        {"renderer": "raster"},
        {"density": "much"},
        {"density": float("nan")},
        {"background": "red"},
        {"clip": [[0, 0], [1, 1]]},
        {"clip": 3},
        {"transfer.points": [[0, "#000000", 0]]},
        {"transfer.points": [[1, "#000000", 0], [0, "#ffffff", 1]]},
        {"transfer.points": [[0, "#000000", 0], [10**400, "#ffffff", 1]]},
        {"transfer.points": [["0", "#000000", 0], ["1", "#ffffff", 1]]},
        {"transfer.points": [[0, "#-1-1-1", 0], [1, "#ffffff", 1]]},
        {"transfer.bumps": [{"x": 0}]},
        {"transfer.bumps": {}},
        {"transfer.bumps": [BUMP | {"a": 10**400}]},
        {"transfer.bumps": [BUMP | {"x": "0"}]},
        {"transfer.preset": "ct_bones"},
        {"camera.target": ["a", 0, 0]},
        {"slices": None},
    ],
    ids=str,
)
def test_an_impossible_change_is_a_sentence_and_changes_nothing(session, changes):
    before = dict(session.state)
    messages = session.handle({"type": "set", "changes": changes})
    assert kinds(messages) == ["error", "state"]
    assert messages[0][0]["text"].endswith(".")
    assert session.state == before


@pytest.mark.parametrize("message", [{}, {"type": "open_file", "path": "/etc/passwd"}, {"type": 3}])
def test_an_unknown_message_is_refused(session, message):
    assert kinds(session.handle(message)) == ["error", "state"]


def moved(control):
    """Two values of a slider, a flag or a colour that differ from its default."""
    if control.kind == "colour":
        return ["#336699", "#993366"]
    at = np.array([0.3, 0.6])
    if control.log:
        values = np.exp(np.log(control.low) + at * np.log(control.high / control.low))
    else:
        values = control.low + at * (control.high - control.low)
    return values.tolist()


@pytest.mark.parametrize("renderer", LABELS)
def test_no_slider_needs_a_new_kernel(session, renderer):
    """Except those of the resolution and of the number of scatterings, which are for kernels."""
    sun = {"renderer": renderer, "light.sun": True}
    session.handle({"type": "set", "changes": sun})
    points = [[0.0, "#102030", 0.0], [0.5, "#ffaa00", 0.7], [1.0, "#ffffff", 1.0]]
    changes = [{"transfer.points": points}, {"transfer.points": points[::2]}]
    changes += [{"clip": [[0, 0, 0], [1, 1, high]]} for high in (0.8, 0.5)]
    changes += [{"camera.target": [0.1, 0, 0]}, {"camera.target": [0, 0.1, 0.2]}]
    for control in session.application.states.controls.values():
        if control.kind in ("slider", "colour") and control.name not in (
            "view.scale",
            "view.moving_scale",
            "depth",
        ):
            changes += [{control.name: value} for value in moved(control)]
    work(session)
    session.handle({"type": "set", "changes": changes[0]})
    work(session)  # what computes the integrals of a table
    with dr.scoped_set_flag(dr.JitFlag.KernelHistory, True):
        for change in changes:
            dr.kernel_history_clear()
            assert kinds(session.handle({"type": "set", "changes": change}))[0] == "state"
            work(session)
            new = [k for k in dr.kernel_history((dr.KernelType.JIT,)) if not k["cache_hit"]]
            assert not new, change


@pytest.mark.parametrize("second", ["", "isosurface"])
@pytest.mark.parametrize("curve", ["range", "logarithmic"])
def test_the_copied_script_writes_the_picture_that_the_page_saves(
    session, tmp_path, monkeypatch, second, curve
):
    monkeypatch.chdir(tmp_path)
    changes = {"renderer": "emission_absorption", "second": second, "camera.azimuth": 75.0}
    changes |= {"tone.stops": 1.0, "tone.curve": curve, "view.scale": 0.5}
    session.handle({"type": "set", "changes": changes})
    work(session), work(session)
    ((message, _),) = session.handle({"type": "copy", "kind": "python"})
    script = (
        message["text"]
        .replace("spp=64", "spp=2")
        .replace("load('smoke')", "load('smoke', size=16)")
    )
    exec(script, {})
    ((file, (png,)),) = session.handle({"type": "save", "kind": "png"})
    from_page, from_script = (np.asarray(Image.open(f)) for f in (io.BytesIO(png), file["name"]))
    assert np.array_equal(from_page, from_script)


@pytest.mark.parametrize("kind", ["film", "frames"])
def test_an_orbit_is_rendered_frame_by_frame_from_the_view_on(session, monkeypatch, kind):
    monkeypatch.setattr(saving, "FRAMES", 3)
    monkeypatch.setattr(saving, "FILM_SAMPLES", 1)
    session.handle({"type": "set", "changes": {"renderer": "maximum_intensity"}})
    work_first_passes(session)
    assert kinds(session.handle({"type": "save", "kind": kind})) == ["busy"]
    sent = [message for _ in range(4) for message in session.work()]
    assert kinds(sent) == ["busy", "busy", "busy", "busy", "file"]
    file = io.BytesIO(sent[-1][1][0])
    if kind == "film":
        first, count = Image.open(file).convert("RGB"), Image.open(file).n_frames
        tolerance = 16  # levels, by the palette
    else:
        archive = zipfile.ZipFile(file)
        count, tolerance = len(archive.namelist()), 0
        first = Image.open(io.BytesIO(archive.read("000.png")))
    assert count == 3
    frame = picture_files.render_state(session.application, session.state, session.size, 1)
    (picture,) = frame.pictures.values()
    view = session.application.develop(session.state, {0: picture})[0]
    assert abs(np.asarray(first).astype(int) - view).mean() <= tolerance
    assert session.work() == []  # the end of the task
    assert session.has_work()


@pytest.mark.parametrize("fails", [False, True])
def test_a_film_of_the_last_volume_is_given_up(session, application, fails):
    """The list of tasks was empty when the step that was rendered meanwhile ended."""

    def step():
        session.open(application.first_state())  # as after a dropped file
        if fails:
            raise KeyError(0)  # such as a setting that the new volume does not have
        yield [({"type": "file"}, [])]

    work_first_passes(session)
    session.tasks.append(step())
    assert session.work() == []
    assert session.tasks == []


def test_a_film_that_fails_is_said_once(session):
    def step():
        yield from ()
        raise BrdfkitError("The file cannot be written.")

    work_first_passes(session)
    session.tasks.append(step())
    assert kinds(work_safely(session)) == ["error", "progress"]
    assert session.work() == session.tasks == []


def test_a_changed_picture_comes_before_the_next_frame_of_a_film(session):
    work_first_passes(session)
    session.handle({"type": "save", "kind": "film"})
    assert kinds(work(session)) == ["busy"]
    session.handle({"type": "set", "changes": {"camera.azimuth": 80}, "moving": True})
    assert kinds(work(session)) == ["picture", "progress"]
    assert kinds(work(session)) == ["busy"]  # while the pointer rests
    session.handle({"type": "set", "changes": {"camera.azimuth": 90}, "moving": False})
    sent = [kinds(work(session))[0] for _ in range(loop_file.FIRST_PASSES + 1)]
    assert sent == [*["picture"] * loop_file.FIRST_PASSES, "busy"]


def test_a_film_is_cancelled(session):
    session.handle({"type": "save", "kind": "film"})
    ((end, _),) = session.handle({"type": "cancel"})
    assert (end["type"], end["text"], session.tasks) == ("busy", "", [])
    session.handle({"type": "save", "kind": "film"})  # and another begins
    assert len(session.tasks) == 1


def test_a_film_shows_the_volume_with_which_it_began(mi, volume, monkeypatch):
    monkeypatch.setattr(saving, "FRAMES", 2)
    own = Session(VolumeApplication(volume, "smoke"))
    message, _ = saving.make_file(own.application, own, "frames")
    (film,) = own.tasks
    other = bk.volumes.Volume(np.arange(27.0).reshape(3, 3, 3), name="other")
    own.exchange(VolumeApplication(other))
    sent = list(film)
    assert (message["can_cancel"], sent[-1][1][0]["name"]) == (True, "smoke.orbit.zip")


def test_another_volume_takes_no_word_on_the_last_picture_for_its_own(session, application):
    ((old, _), _) = session.work()
    session.open(application.first_state())
    assert not session.has_work()  # before the page has drawn the old one
    session.handle({"type": "shown", "number": old["number"]})
    ((new, _), _) = session.work()
    assert new["number"] == old["number"] + 1
    session.handle({"type": "shown", "number": old["number"]})
    assert session.shown < session.number
    session.handle({"type": "shown", "number": 10**9})
    assert session.shown == session.number


def test_no_picture_of_the_last_volume_comes_after_another_was_opened(
    session, application, monkeypatch
):
    work(session)
    assert session.describe_view()[0]["number"] == session.number == 1
    render = application.render

    def open_meanwhile(*arguments):
        session.open(application.first_state())
        return render(*arguments)

    monkeypatch.setattr(application, "render", open_meanwhile)
    session.handle({"type": "set", "changes": {"camera.azimuth": 1}, "moving": True})
    assert session.work() == []
    assert session.number == 1


def test_a_picture_says_what_it_shows_and_fits_its_overlay(session):
    session.handle({"type": "resize", "width": 300, "height": 200})
    changes = {"renderer": "isosurface", "view.moving_scale": 0.125}
    session.handle({"type": "set", "changes": changes, "moving": True})
    ((picture, (content,)), _) = work(session)
    width, height = Image.open(io.BytesIO(content)).size
    assert width / height == session.size[0] / session.size[1]
    assert (picture["name"], picture["needs"]) == ("Isosurface", {"renderer": "isosurface"})
    camera = session.application.states.camera(session.state)
    side = np.array(camera.target) + camera.axes[0] * picture["overlay"]["across"] / 2
    assert camera.project(side[None], width / height)[0, 0] == pytest.approx(
        0.5 - height / width / 2
    )


def test_the_last_picture_is_sent_without_loss_when_the_page_is_ready(session, monkeypatch):
    monkeypatch.setattr(loop_file, "LARGEST_SAMPLES", 3)
    ((first, _), _) = session.work()
    assert session.work() == session.work() == []  # it converges while the page draws
    assert session.converged
    assert not session.has_work()
    session.handle({"type": "shown", "number": first["number"]})
    assert session.has_work()
    ((last, (content,)), _) = session.work()
    assert (last["mime"], content[:4]) == ("image/png", b"\x89PNG")
    session.handle({"type": "shown", "number": last["number"]})
    assert not session.has_work()


def test_rendering_stops_when_the_page_says_nothing_more(session, monkeypatch):
    session.work()
    assert session.has_work()
    monkeypatch.setattr(loop_file, "PATIENCE", 0.0)
    assert not session.has_work()
    session.handle({"type": "shown", "number": session.number})
    assert session.has_work()


def test_messages_and_pictures_do_not_wait_for_each_other_for_ever(application, monkeypatch):
    """The thread that rendered held the lock of the kernels, and waited for the session's."""
    from brdfkit.core.jit.threads import in_turn

    own, rendering = Session(application), threading.Event()

    def render(*_):
        rendering.set()
        time.sleep(0.1)
        return np.zeros((32, 32, 3), np.float32)

    def answer(*_):
        in_turn(lambda: None)()  # as after a dropped environment map
        return []

    monkeypatch.setattr(application, "render", in_turn(render))
    monkeypatch.setattr(application, "answer", answer)
    thread = threading.Thread(target=work_safely, args=[own], daemon=True)
    thread.start()
    rendering.wait()
    with own.lock:
        time.sleep(0.2)
        assert own.handle({"type": "save"}) == []
    thread.join(5)
    assert not thread.is_alive()


def test_messages_are_answered_while_a_picture_is_encoded(session, monkeypatch):
    develop, answered = session.application.develop, []

    def develop_slowly(*arguments, **settings):
        thread = threading.Thread(target=session.handle, args=[{"type": "undo"}], daemon=True)
        thread.start()
        thread.join(5)
        answered.append(not thread.is_alive())
        return develop(*arguments, **settings)

    monkeypatch.setattr(session.application, "develop", develop_slowly)
    session.work()
    assert answered == [True]


def test_a_long_answer_to_one_page_does_not_hold_up_the_others(session):
    held = threading.Event()

    def answer():
        with session.lock:
            held.wait()

    thread = threading.Thread(target=answer, daemon=True)
    thread.start()
    while session.lock.acquire(blocking=False):
        session.lock.release()
    start = time.monotonic()
    assert session.work() == []
    assert time.monotonic() - start < 5
    held.set()
    thread.join()
    assert session.has_work()


def test_saved_settings_and_functions_come_back(session, tmp_path):
    session.handle({"type": "set", "changes": {"transfer.mode": "bumps2d", "density": 2.0}})
    ((_, (state,)),) = session.handle({"type": "save", "kind": "state"})
    ((_, (function,)),) = session.handle({"type": "save", "kind": "transfer"})
    before = dict(session.state)
    session.handle({"type": "reset"})
    piece = {"type": "upload", "name": "view.json", "size": len(state), "offset": 0}
    answers = session.handle(piece | {"count": 1, "index": 0}, state)
    assert kinds(answers)[-1] == "state"
    assert session.state == before
    path = tmp_path / "f.json"
    path.write_bytes(function)
    loaded = bk.volumes.TransferFunction.load(path)
    assert loaded.extinction == pytest.approx(2 * before["transfer.extinction"])
    assert loaded.gradients is not None


def test_a_dropped_volume_replaces_the_one_that_is_shown(session, volume, tmp_path):
    import nibabel

    values = np.arange(4 * 5 * 6, dtype=np.float32).reshape(4, 5, 6)
    path = tmp_path / "head.nii.gz"
    nibabel.save(nibabel.Nifti1Image(values, np.diag([2, 2, 3, 1])), path)
    data, half = path.read_bytes(), 40
    piece = {"type": "upload", "name": "../../head.nii.gz", "size": len(data)}
    piece |= {"count": 1, "index": 0}
    own = DropSession(VolumeApplication(volume))
    assert kinds(own.handle(piece | {"offset": 0}, data[:half])) == ["uploaded"]
    ((opened, _), *_) = own.handle(piece | {"offset": half}, data[half:])
    assert (opened["type"], opened["volume"]["size"]) == ("open", (4, 5, 6))
    assert opened["volume"]["axes"] == "RAS"


def test_raw_voxels_ask_for_their_header(volume):
    data = bytes(range(64))
    piece = {"type": "upload", "name": "x.raw", "size": 64, "offset": 0}
    own = DropSession(VolumeApplication(volume))
    ((question, _),) = own.handle(piece | {"count": 1, "index": 0}, data)
    assert (question["type"], question["guess"]["size"]) == ("ask_raw", [4, 4, 4])
    header = {"type": "raw", "size": [4, 4, 4], "dtype": "uint8", "spacing": [1, 1, 2]}
    ((opened, _), *_) = own.handle(header)
    assert opened["volume"]["spacing"] == (1, 1, 2)


def test_a_damaged_file_is_a_sentence(volume):
    own = DropSession(VolumeApplication(volume))
    piece = {"type": "upload", "name": "x.nii", "size": 3, "offset": 0}
    messages = own.handle(piece | {"count": 1, "index": 0}, b"abc")
    assert kinds(messages) == ["error", "state"]
    assert own.upload.folder is None


def test_the_voxel_under_the_pointer(session, volume):
    session.handle({"type": "set", "changes": {"renderer": "isosurface", "level": 0.3}})
    ((message, _),) = session.handle({"type": "probe", "x": 0.5, "y": 0.5})
    i, j, k = message["voxel"]
    near = volume.values[max(k - 1, 0) : k + 2, max(j - 1, 0) : j + 2, max(i - 1, 0) : i + 2]
    assert near.min() <= 0.3 <= near.max()
    assert f"voxel {i}, {j}, {k}" in message["text"]
    ((outside, _),) = session.handle({"type": "probe", "x": 0.0, "y": 0.0})
    assert outside["text"] == ""


def test_slices_are_sent_when_they_are_shown_and_moved(session, volume):
    answers = session.handle({"type": "set", "changes": {"show.slices": True}})
    assert kinds(answers) == ["state", "slices"]
    assert [plane["name"] for plane in answers[1][0]["planes"]] == ["z", "y", "x"]
    ((probe, _),) = session.handle({"type": "probe_slice", "plane": 0, "x": 0.99, "y": 0.99})
    assert probe["voxel"] == [15, 0, 8]
    assert probe["text"].startswith(f"{volume.values[8, 0, 15]:.6g} at voxel 15, 0, 8")


def test_pages_of_a_volume_share_its_grid_and_its_histograms(application, volume, monkeypatch):
    other = VolumeApplication(volume, "smoke")
    assert other.states.live is application.states.live
    first = application.describe()
    monkeypatch.setattr(histograms, "_count_voxels", None)  # which is not called again
    assert other.describe() == first
    assert VolumeApplication(volume.resized(2)).states.live is not application.states.live


def test_only_the_slices_that_change_are_sent(session):
    shown = {"show.slices": True, "slices": [3, 8, 8]}
    session.handle({"type": "set", "changes": shown})
    moved = session.handle({"type": "set", "changes": {"slices": [4, 8, 8]}})
    ((_, _), (message, pictures)) = moved
    assert [plane["name"] for plane in message["planes"]] == ["x"]
    assert len(pictures) == 1
    assert kinds(session.handle({"type": "set", "changes": {"slices": [4, 8, 8]}})) == ["state"]


def test_an_error_of_the_renderer_is_said_and_pauses(session, monkeypatch):
    def fail(*_):
        raise BrdfkitError("The extinction is too large.")

    monkeypatch.setattr(session.application, "render", fail)
    messages = work_safely(session)
    assert kinds(messages) == ["error", "progress"]
    assert messages[1][0]["paused"]
