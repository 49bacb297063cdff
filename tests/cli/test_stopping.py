"""Ctrl-C and odd surroundings: every command ends at once and cleanly, in a sentence."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import click
import pytest
from click.testing import CliRunner
from small_files import merl

import brdfkit as bk
from brdfkit.cli import main
from brdfkit.cli.errors import Group, print_message
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.interrupts import is_stopped_by_signal

SHAPE = (6, 4, 8)


@click.group(cls=Group)
def group():
    """A command line of its own."""


def press():
    os.kill(os.getpid(), signal.SIGINT)
    time.sleep(1)  # within which the handler runs


@group.command()
@click.argument("becomes")
def work(becomes):
    """Press Ctrl-C, of which native code makes another error."""
    try:
        press()
    except KeyboardInterrupt as stop:
        if becomes == "nothing":
            raise
        error = {"native": RuntimeError, "sentence": BrdfkitError, "memory": MemoryError}[becomes]
        raise error(f"cannot load it ({stop!r}).") from stop


@pytest.mark.quick
@pytest.mark.parametrize("becomes", ["nothing", "native", "sentence", "memory"])
def test_ctrl_c_ends_a_command_whatever_native_code_makes_of_it(becomes):
    """`render smoke --seconds 60` said "cannot load it (KeyboardInterrupt:)", with status 2."""
    before = signal.getsignal(signal.SIGINT)
    found = CliRunner().invoke(group, ["work", becomes])
    assert (found.exit_code, found.stderr) == (130, "brdfkit: interrupted.\n")
    assert signal.getsignal(signal.SIGINT) is before


@pytest.mark.quick
def test_each_command_begins_unstopped():
    CliRunner().invoke(group, ["work", "nothing"])
    assert is_stopped_by_signal()
    assert CliRunner().invoke(group, ["work", "wrong"]).exit_code == 130
    CliRunner().invoke(group, ["work", "--help"])
    found = CliRunner().invoke(group, ["nothing"])
    assert found.exit_code == 2


WITHIN_EXEC = """
import click
from brdfkit.cli.errors import Group

@click.group(cls=Group)
def group():
    pass

@group.command()
def work():
    exec("raise KeyboardInterrupt")

group()
"""


def test_ctrl_c_within_exec_has_the_status_too():
    """Python ended by the signal where Ctrl-C came while a dataclass was made."""
    words = sys.executable, "-c", WITHIN_EXEC, "work"
    done = subprocess.run(words, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (130, "brdfkit: interrupted.\n")


WITHIN_IMPORTS = """
import os, signal, sys
from brdfkit.__main__ import main

class Presser:
    def find_spec(self, name, *_):
        if name == "click":
            os.kill(os.getpid(), signal.SIGINT)

sys.meta_path.insert(0, Presser())
{}
main()
"""


@pytest.mark.parametrize(
    ("before", "expected"),
    [
        ("", (130, "", "brdfkit: interrupted.\n")),
        # As the shell does for a command in the background
        (
            "signal.signal(signal.SIGINT, signal.SIG_IGN)",
            (0, f"brdfkit, version {bk.__version__}\n", ""),
        ),
    ],
)
def test_ctrl_c_within_imports_is_a_sentence(before, expected):
    words = sys.executable, "-c", WITHIN_IMPORTS.format(before), "--version"
    done = subprocess.run(words, capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr) == expected


@pytest.mark.quick
@pytest.mark.parametrize("words", [["info"], ["fit"], ["convert"], ["render"]])
def test_a_name_that_is_too_long_is_a_sentence(words, tmp_path):
    output = [str(tmp_path / "a.csv")] if words == ["convert"] else []
    found = CliRunner().invoke(main, [*words, "9" * 400, *output])
    assert (found.exit_code, found.stderr.count("\n")) == (2, 1)
    assert "Traceback" not in found.stderr


@pytest.mark.quick
def test_sentences_are_short_and_always_printable(capsys):
    print_message("caf\udce9: " + "9" * 10_000)
    told = capsys.readouterr().err
    assert told.startswith("brdfkit: caf?: 99")
    assert len(told) < 3_000


ASCII = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}


@pytest.mark.parametrize(
    ("name", "locale"),
    [(b"caf\xe9", {"LC_ALL": "C.UTF-8"}), ("θ é".encode(), ASCII)],
    ids=["a name that is no UTF-8", "a name that is no ASCII"],
)
def test_any_name_of_a_file_is_read_and_written(tmp_path, name, locale):
    """A report, a picture by native code, and fits: in a process, which has the locale from its
    start."""
    folder = os.fsencode(tmp_path) + b"/" + name
    os.mkdir(folder)
    paint = folder + b"/" + name + b".binary"
    Path(os.fsdecode(paint)).write_bytes(merl(SHAPE))
    code = """
import sys
from brdfkit.cli import main

name, (paint,) = sys.argv[1], sys.argv[2:]
small = ["--size", "32", "--spp", "1"]
for words in (
    ["report", paint, "-m", "lambert", "-o", name + ".html", *small],
    ["fit", paint, "-m", "lambert", "-o", name + "fits", "--render", *small],
    ["fit", paint, "plaster", "-m", "lambert", "-o", name + "sweep"],
    ["info", paint, "-o", name + ".png"],
):
    main(words, standalone_mode=False)
"""
    env = {n: v for n, v in os.environ.items() if n not in ("LC_ALL", "PYTHONIOENCODING")}
    words = [sys.executable, "-c", code, name, paint]
    done = subprocess.run(words, cwd=folder, env=env | locale, capture_output=True)
    assert done.returncode == 0, done.stderr.decode(errors="replace")
    text = {".html", ".csv", ".json"}
    files = [file for file in Path(os.fsdecode(folder)).rglob("*") if file.is_file()]
    assert {file.suffix for file in files} == text | {".binary", ".png", ".exr"}
    assert not [file for file in files if file.name.startswith(".brdfkit-")]
    for file in files:
        if file.suffix in text:
            file.read_bytes().decode("utf-8")


@pytest.mark.quick
def test_ctrl_c_within_a_check_is_no_failure_of_it(llvm_variant, monkeypatch):
    from brdfkit.checks.registry import checks

    def stopped(_subject):
        try:
            raise KeyboardInterrupt
        except KeyboardInterrupt as stop:
            raise RuntimeError("see above") from stop  # as Dr.Jit does

    monkeypatch.setitem(checks["bsdfs"], next(iter(checks["bsdfs"])), stopped)
    with pytest.raises(KeyboardInterrupt):
        bk.check("lambert")


@pytest.mark.quick
def test_ctrl_c_within_a_recorded_picture_is_no_reason_to_render_again(llvm_variant, monkeypatch):
    """A claim of a thesis went on for minutes: Dr.Jit makes a RuntimeError of Ctrl-C."""
    from brdfkit.theses.lesar2018.iterations import make_renderer

    def stopped(*_args, **_options):
        raise KeyboardInterrupt

    monkeypatch.setattr(llvm_variant, "render", stopped)
    with pytest.raises(KeyboardInterrupt):
        make_renderer()(llvm_variant.load_dict({"type": "scene"}), 0)
