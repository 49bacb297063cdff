"""`brdfkit view`: the picture that it writes, the sentence that it prints, and its end."""

import contextlib
import json
import os
import shlex
import signal
import subprocess
import sys
import time
import webbrowser

import nibabel
import numpy as np
import pytest
from click.testing import CliRunner

from brdfkit.cli import main
from brdfkit.cli.commands import view
from brdfkit.lighting.environments.map_files import read_map
from brdfkit.viewing import server
from brdfkit.viewing.session import Session
from brdfkit.viewing.volumes import source
from brdfkit.viewing.volumes.application import VolumeApplication

ADDRESS = "http://127.0.0.1:8000/token/"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The current folder, with the volume head.nii."""
    monkeypatch.chdir(tmp_path)
    values = np.random.default_rng(0).random((16, 16, 16), np.float32)
    nibabel.save(nibabel.Nifti1Image(values, np.eye(4)), "head.nii")
    return tmp_path


def run(*words):
    return CliRunner().invoke(main, ["view", *map(str, words)])


def test_a_picture_replaces_another_only_by_force(mi, folder):
    words = "head.nii", "--size", "48x32", "--state", '{"renderer": "maximum_intensity"}'
    done = run(*words, "-o", "a.png", "--spp", 1)
    assert (done.exit_code, "written: a.png" in done.stdout) == (0, True)
    (folder / "a.png").write_bytes(b"precious")
    refused = run(*words, "-o", "a.png", "--spp", 1)
    assert (refused.exit_code, "add --force" in refused.stderr) == (2, True)
    assert (folder / "a.png").read_bytes() == b"precious"
    assert run(*words, "-o", "a.png", "--spp", 1, "--force").exit_code == 0
    record = json.loads(run(*words, "-o", "a.png", "--spp", 1, "--json").stdout)
    assert (record["spp"], record["written"]) == (1, ["a.png"])


def test_the_values_are_labels_if_the_user_says_so(mi, folder, monkeypatch):
    made, init = [], VolumeApplication.__init__
    monkeypatch.setattr(
        VolumeApplication, "__init__", lambda own, *given: made.append(own) or init(own, *given)
    )
    tissues = np.indices((8, 8, 8), np.uint8).sum(0, dtype=np.uint8) // 4
    nibabel.save(nibabel.Nifti1Image(tissues, np.eye(4)), "atlas.nii")
    words = "atlas.nii", "-o", "a.png", "--spp", 1, "--size", "32x32", "--force"
    said = [run(*words, *option).stderr for option in ([], ["--labels"], ["--no-labels"])]
    assert [own.volume.labels for own in made] == [False, True, False]
    assert ["may hold labels" in text for text in said] == [True, False, False]


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["no.nii", "-o", "a.jpg"], "written as .exr or .png"),
        (["no.nii", "-o", "a.png", "--size", "12"], "--size 12 should be width and height"),
        (["no.nii", "-o", "a.png", "--size", "0x9"], "--size 0x9 should be width and height"),
        (["no.nii", "-o", "a.png", "--size", f"{'9' * 5000}x9"], "should be width and height"),
        (["head.nii", "-o", "a.png", "--size", "99999x99999"], "GB are available; give a smaller"),
        (["no.nii", "--state", '{"a":' + 99_999 * "["], "--state is no JSON"),
        (["head.nii", "-o", "head.nii"], "written as .exr or .png"),
        (["head.nii", "--state", '{"renderer": "raster"}'], "'raster' is not possible"),
    ],
)
def test_a_wrong_word_is_refused_before_the_work(folder, words, sentence):
    done = run(*words)
    assert (done.exit_code, sentence in done.stderr) == (2, True)


def test_the_copied_command_writes_the_picture_of_the_page(mi, folder):
    session = Session(VolumeApplication(*source.load_within_memory("head.nii", downsample=2)))
    session.handle({"type": "hello", "width": 128, "height": 256, "state": None})
    changes = {"renderer": "isosurface", "level": 0.55, "view.scale": 0.5}
    session.handle({"type": "set", "changes": changes})
    for _ in range(2):
        session.work()
    ((message, _),) = session.handle({"type": "copy", "kind": "command"})
    text = message["text"].replace("--spp 64", "--spp 2").replace("head.png", "head.exr")
    assert run(*shlex.split(text)[2:]).exit_code == 0
    ((_, (content,)),) = session.handle({"type": "save", "kind": "exr"})
    (folder / "page.exr").write_bytes(content)
    first, second = (read_map(folder / name) for name in ("page.exr", "head.exr"))
    assert first.shape == (128, 64, 3)
    np.testing.assert_allclose(first, second, rtol=1e-5, atol=1e-6)


def test_a_taken_port_is_said_before_the_volume_is_read():
    taken = server.open_socket(0)
    port = taken.getsockname()[1]
    done = run("no.nii", "--port", port)
    taken.close()
    assert done.exit_code == 2
    assert f"Port {port} of 127.0.0.1 cannot be used" in done.stderr


@pytest.mark.quick
def test_one_sentence_says_where_the_page_is(monkeypatch):
    monkeypatch.delenv("SSH_CONNECTION", raising=False)
    for opened, start in ((True, "head is shown at"), (False, "head: open")):
        sentence = view._describe_page("head", ADDRESS, opened)
        assert sentence.startswith(f"{start} {ADDRESS} ")
    monkeypatch.setenv("SSH_CONNECTION", "10.0.0.2 50000 10.0.0.1 22")
    sentence = view._describe_page("head", ADDRESS, False)
    assert "'ssh -L 8000:127.0.0.1:8000 10.0.0.1'" in sentence
    assert ADDRESS in sentence


@pytest.mark.quick
def test_a_browser_is_opened_only_where_it_has_a_window(monkeypatch):
    opened = []
    monkeypatch.setattr(webbrowser, "open", lambda address: opened.append(address) or True)
    monkeypatch.setattr(sys, "platform", "linux")
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "SSH_CONNECTION"):
        monkeypatch.delenv(name, raising=False)
    assert not view._open_browser(ADDRESS)
    monkeypatch.setenv("DISPLAY", ":0")
    assert view._open_browser(ADDRESS)
    monkeypatch.setenv("SSH_CONNECTION", "10.0.0.2 50000 10.0.0.1 22")
    assert not view._open_browser(ADDRESS)
    assert opened == [ADDRESS]


def test_the_volume_is_loaded_once_and_the_first_page_has_the_first_view(folder, monkeypatch):
    made, pages, loaded = [], [], []
    first_init = VolumeApplication.__init__

    def init(self, *arguments):
        made.append(self)
        first_init(self, *arguments)

    @contextlib.contextmanager
    def serve(make_application, listening):
        listening.close()
        pages.append(make_application())
        loaded.append(pages[0].volume)
        pages.append(make_application())
        yield ADDRESS
        raise AssertionError

    def press(_):
        raise KeyboardInterrupt

    monkeypatch.setattr(VolumeApplication, "__init__", init)
    monkeypatch.setattr(server, "serve", serve)
    monkeypatch.setattr(time, "sleep", press)
    done = run("head.nii", "--no-browser", "--state", '{"renderer": "isosurface"}')
    assert (done.exit_code, done.stdout.count("\n")) == (130, 1)
    assert pages == made
    assert pages[0] is not pages[1]
    assert pages[1].volume is loaded[0]
    assert pages[1].first_state()["renderer"] == "isosurface"


def time_the_end(temporary, rendering):
    """The seconds that a view takes to end after Ctrl-C; it may render for a page meanwhile."""
    from websockets.sync.client import connect

    words = sys.executable, "-m", "brdfkit", "view", "head.nii", "--no-browser"
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    with subprocess.Popen(words, env=os.environ | {"TMPDIR": str(temporary)}, **pipes) as program:
        address = next(word for word in program.stdout.readline().split() if "http" in word)
        origin, place = "/".join(address.split("/")[:3]), address.replace("http", "ws")
        with contextlib.ExitStack() as stack:
            if rendering:
                page = stack.enter_context(connect(f"{place}session", origin=origin))
                large = {"view.scale": 2.0, "depth": 64}
                hello = {"type": "hello", "width": 2048, "height": 2048, "state": large}
                page.send(json.dumps(hello))
                piece = {"type": "upload", "name": "a.nii", "size": 9}
                page.send(json.dumps(piece | {"offset": 0, "index": 0, "count": 1, "bytes": [1]}))
                page.send(b"x")
                assert json.loads(page.recv())["type"] == "open"
                time.sleep(1)
            start = time.monotonic()
            program.send_signal(signal.SIGINT)
            _, errors = program.communicate(timeout=60)
            taken = time.monotonic() - start
    assert (program.returncode, errors) == (130, "brdfkit: interrupted.\n")
    assert list(temporary.iterdir()) == []  # of what the page has sent
    return taken


@pytest.mark.parametrize("rendering", [False, True])
def test_ctrl_c_ends_it_within_a_second(folder, rendering):
    temporary = folder / "temporary"
    temporary.mkdir()
    # Where other programs keep this computer busy, a second of this one's share takes longer
    limit = max(1.0, os.getloadavg()[0] / (os.cpu_count() or 1))
    assert any(time_the_end(temporary, rendering) < limit for _ in range(3))
