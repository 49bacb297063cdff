"""What commands write: never a file that they read, and no other's file without --force."""

import shutil

import pytest
from click.testing import CliRunner

import brdfkit as bk
from brdfkit.cli import main, outputs
from brdfkit.lighting.environments import map_files

SCENE = """<scene version="3.0.0"><integrator type="path"/><sensor type="perspective">
<film type="hdrfilm"><integer name="width" value="8"/><integer name="height" value="8"/></film>
</sensor><shape type="sphere"><bsdf type="diffuse"><texture name="reflectance" type="bitmap">
<string name="filename" value="tex.png"/></texture></bsdf></shape>
<emitter type="constant"/></scene>"""
SMALL = "--spp", "1", "--size", "8"


@pytest.fixture
def run(tmp_path, monkeypatch):
    """A function that runs a command in an empty folder: its exit status and its output."""
    monkeypatch.chdir(tmp_path)
    bk.render("ggx", spp=1, size=8).write("tex.png")
    (tmp_path / "s.xml").write_text(SCENE)
    grid = bk.Measured.from_samples([[0.0, 0.6, 0.8]] * 2, [[0.0, 0.0, 1.0]] * 2, [[0.1], [0.1]])
    bk.save(grid, "grid.csv")
    shutil.copy(map_files.find_map("studio"), "e.exr")

    def command(*words):
        found = CliRunner().invoke(main, words)
        return found.exit_code, found.output

    return command


READ = {
    "render": ("render", "lambert", "--envmap", "e.exr", *SMALL, "-o", "e.exr"),
    "scene": ("render", "s.xml", "--spp", "1", "-o", "tex.png"),
    "picture of a scene": ("render", "s.xml", "--spp", "1", "-o", "tex.exr"),
    "convert": ("convert", "grid.csv", "grid.csv"),
    "report": ("report", "grid.csv", "-m", "lambert", "-o", "grid.csv"),
}


@pytest.mark.parametrize("force", [(), ("--force",)], ids=["plain", "force"])
@pytest.mark.parametrize("name", READ)
def test_no_input_is_written(name, force, run, tmp_path):
    before = {file: file.read_bytes() for file in tmp_path.iterdir()}
    status, output = run(*READ[name], *force)
    assert status == 2, output
    assert before == {file: file.read_bytes() for file in tmp_path.iterdir()}
    assert "is a file to read" in output or name == "report"


WRITE = {
    "a.png": ("render", "lambert", *SMALL),
    "b.exr": ("render", "lambert", *SMALL),
    "c.astm": ("convert", "grid.csv"),
}


@pytest.mark.parametrize("output", WRITE)
def test_files_of_others_are_replaced_by_force_only(output, run, tmp_path):
    name, *words = WRITE[output]
    words = (name, *words) + (() if name == "convert" else ("-o",)) + (output,)
    for _ in range(2):  # the same command may do so
        status, said = run(*words)
        assert status == 0, said
    file = tmp_path / output
    file.write_bytes(b"precious")
    status, said = run(*words)
    assert status == 2
    assert f"{output} exists already, and another command wrote it" in said
    assert file.read_bytes() == b"precious"
    status, said = run(*words, "--force")
    assert status == 0, said
    assert file.read_bytes() != b"precious"


@pytest.mark.quick
def test_another_render_of_the_same_name_asks(run, tmp_path):
    assert run("render", "lambert", *SMALL)[0] == 0
    before = (tmp_path / "lambert.png").read_bytes()
    status, said = run("render", "lambert", "--seed", "1", *SMALL)
    assert status == 2
    assert "--force" in said
    assert (tmp_path / "lambert.png").read_bytes() == before


@pytest.mark.quick
def test_no_file_of_another_command_is_read_whole(run, monkeypatch):
    assert run("render", "lambert", *SMALL)[0] == 0
    monkeypatch.setattr(outputs, "compute_sha256", lambda path: pytest.fail(f"read {path}"))
    status, said = run("render", "lambert", "--seed", "1", *SMALL)
    assert status == 2, said


@pytest.mark.quick
def test_a_folder_of_fits(run, tmp_path):
    words = "fit", "grid.csv", "-m", "lambert", "-o", "fits"
    assert run(*words)[0] == 0
    assert run(*words)[0] == 0
    (tmp_path / "fits" / "lambert.json").write_text("{}")
    assert "exists already" in run(*words)[1]
    assert (tmp_path / "fits" / "lambert.json").read_text() == "{}"


@pytest.mark.quick
def test_without_a_cache_folder_a_command_may_still_write_twice(run, monkeypatch, tmp_path):
    """What it wrote in this run is its own; the next run asks."""
    (tmp_path / "no folder").write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "no folder"))
    words = "render", "lambert", *SMALL, "-o", "a.exr"
    assert run(*words)[0] == 0
    assert "--force" in run(*words)[1]
    assert run(*words, "--force")[0] == 0
