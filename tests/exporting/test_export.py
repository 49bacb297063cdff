"""Exports: every target × every fit, what was lost, and errors in a sentence."""

import ast
import json
import re
import runpy
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest
from click.testing import CliRunner
from six_fits import SIX_FITS, make_fit

import brdfkit as bk
from brdfkit.cli import main
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.geometry.directions import from_angles
from brdfkit.exporting.hold import list_held_models
from brdfkit.exporting.loss import measure_loss
from brdfkit.exporting.target import COLUMNS
from brdfkit.exporting.targets import blender, list_targets
from brdfkit.materials.converting import draw_direction_pairs

TARGETS = list_targets()
PAIRS = draw_direction_pairs(200, seed=1)


@pytest.fixture
def cli(tmp_path, monkeypatch):
    """A function that runs a command in an empty folder: its exit status and its output."""
    monkeypatch.chdir(tmp_path)

    def command(*words):
        done = CliRunner().invoke(main, words)
        return done.exit_code, done.output

    return command


# Tables and fits to the target's formula take seconds, whatever the material
SLOW = {"csv", "gltf", "mitsuba", "openmaterial", "pbrt", "radiance"}


def is_tried(target, name):
    """Whether a fit is exported to a target here; tests/oracles exports all of them."""
    if target in SLOW:
        return name in ("plastic", "brushed")
    return name != "fabric" or target == "blender"  # which every formula is fitted to alike


@pytest.mark.parametrize(
    ("target", "name"), [(t, n) for t in TARGETS for n in SIX_FITS if is_tried(t, n)]
)
def test_a_file_says_its_source_and_what_was_lost(target, name, tmp_path):
    fit, aim = make_fit(name), TARGETS[target]
    done = bk.export(fit, target, tmp_path / f"a{aim.suffix}", accept_loss=True)
    assert all(path.is_file() for path in done.paths)
    assert done.paths[0] == tmp_path / f"a{aim.suffix}"
    loss = measure_loss(fit, done.drawn)
    assert (done.log_error, done.delta_e) == (loss.log_error, loss.delta_e)
    assert bool(done.changes) == (loss.log_error > 1e-6 or loss.delta_e > 1e-3), done.changes
    text = b"".join(path.read_bytes() for path in done.paths).decode("utf-8", "replace")
    words = [fit.label(), f"brdfkit {bk.__version__}", f"bk.export(model, '{target}', "]
    for word in words:
        assert word in text, word
    if name == "brushed":
        widths = re.search("Highlight 1: GGX, alpha_u = (.*?), alpha_v = (.*?) ", text)
        np.testing.assert_allclose([float(w) for w in widths.groups()], (0.36, 0.14), rtol=0.05)
    assert len(repr(done)) < 1000


@pytest.mark.parametrize("target", TARGETS)
def test_a_target_is_described(target):
    assert set(TARGETS[target].holds) == set(COLUMNS)
    assert TARGETS[target].name == target


@pytest.mark.parametrize("name", SIX_FITS)
def test_the_function_in_python_has_the_values_that_were_told(name, tmp_path):
    done = bk.export(make_fit(name), "python", tmp_path / "a.py", accept_loss=True)
    brdf = runpy.run_path(str(done.paths[0]))["brdf"]
    np.testing.assert_allclose(brdf(*PAIRS), done.drawn.eval(*PAIRS), rtol=1e-7)
    assert len(done.paths[0].read_text().splitlines()) < 70


def test_a_saved_fit_tells_its_data_and_licence(cli, tmp_path):
    bk.save(bk.fit("red_plastic", "lambert"), tmp_path / "rot, ähnlich.json")
    status, output = cli("export", "rot, ähnlich.json", "python")
    assert (status, output) == (0, "written: rot, ähnlich_brdf.py (nothing lost)\n")
    text = (tmp_path / "rot, ähnlich_brdf.py").read_text()
    assert "lambert fitted to red_plastic" in text
    assert "Licence of the measured data: BSD-3-Clause" in text
    assert "Made by: brdfkit export 'rot, ähnlich.json' python -o 'rot, ähnlich_brdf.py'" in text


def test_materialx_has_openpbr_by_its_names(tmp_path):
    model = bk.models()["openpbr"](specular_roughness_anisotropy=-0.5, coat_weight=0.5)
    done = bk.export(model, "materialx", tmp_path / "a.mtlx")
    loss = measure_loss(model, done.drawn)
    assert (done.log_error, done.delta_e) == (loss.log_error, loss.delta_e)
    assert 0 < done.delta_e < 1
    (surface,) = ElementTree.parse(done.paths[0]).getroot().iter("open_pbr_surface")
    inputs = {given.get("name"): given for given in surface}
    assert inputs["coat_weight"].get("value") == "0.5"
    assert inputs["specular_roughness_anisotropy"].get("value") == "0.5"
    assert inputs["geometry_tangent"].get("nodename") == "a_bitangent"


def test_what_is_drawn_can_be_compared_and_plotted(tmp_path):
    done = bk.export(bk.models()["gltf"](clearcoat=0.5), "gltf", tmp_path / "a.glb")
    assert list(bk.compare("red_plastic", done.drawn).errors) == ["gltf"]
    assert bk.plot(done.drawn)


def test_materialx_has_highlights_that_are_not_clamped(tmp_path):
    model = bk.models()["ggx"](alpha_u=0.3, specular_reflectance=[5, 1, 1], f0=0.5)
    (file,) = bk.export(model, "materialx", tmp_path / "a.mtlx").paths
    colours = [
        np.fromstring(given.get("value"), sep=",")
        for given in ElementTree.parse(file).getroot().iter("input")
        if given.get("name") == "color0"
    ]
    assert np.max(colours) <= 1
    np.testing.assert_allclose(np.sum(colours, axis=0), [2.5, 0.5, 0.5])


def test_blender_has_no_more_nodes_than_cycles_draws(tmp_path):
    model = bk.models()["ggx"](alpha_u=0.3, specular_reflectance=1000, f0=0.04)
    done = bk.export(model, "blender", tmp_path / "a.py", accept_loss=True)
    assert done.changes == ("highlights at grazing angles became greyer, or darker",)
    assert done.log_error > 0.1


def test_a_fit_named_by_its_model_becomes_a_file_named_by_its_material(cli, tmp_path):
    (tmp_path / "fits").mkdir()
    bk.save(bk.fit("red_plastic", "lambert"), tmp_path / "fits" / "lambert.json")
    assert cli("export", "fits/lambert.json", "glsl")[1].startswith("written: red_plastic.glsl ")


def test_the_same_command_makes_the_same_file(cli, tmp_path):
    words = "export", "ggx", "glsl", "--set", "alpha_u=0.3", "-o", "a.glsl"
    cli(*words)
    before = (tmp_path / "a.glsl").read_bytes()
    assert cli(*words)[0] == 0
    assert (tmp_path / "a.glsl").read_bytes() == before
    assert b"-p alpha_u=0.3" in before


def test_a_visible_loss_is_refused_until_it_is_accepted(cli, tmp_path):
    words = "export", "eon", "materialx", "--set", "roughness=1", "-o", "a.mtlx"
    status, output = cli(*words)
    assert status == 2
    assert re.search(
        r"mean ΔE of \d+\.\d .*refitted as ggx.*--exportable materialx.*--accept-loss", output, re.S
    ), output
    assert not list(tmp_path.iterdir())
    status, output = cli(*words, "--accept-loss", "--json")
    assert status == 0
    assert json.loads(output)["delta_e"] > 2
    made = "Made by: brdfkit export eon materialx -o a.mtlx -p roughness=1 -a\n"
    assert made in (tmp_path / "a.mtlx").read_text()


def test_targets_are_listed(cli, monkeypatch):
    status, output = cli("export", "--json")
    assert status == 0
    assert list(json.loads(output)) == list(TARGETS)
    monkeypatch.setenv("COLUMNS", "80")
    output = cli("export")[1]
    assert all(output.count(f"\n {target} ") == 2 for target in TARGETS), output


def test_default_names_do_not_meet():
    assert len({aim.name_file("a") for aim in TARGETS.values()}) == len(TARGETS)


@pytest.mark.parametrize(("target", "model"), [("radiance", "ward"), ("materialx", "openpbr")])
def test_a_table_and_a_surface_are_held(target, model):
    assert model in list_held_models(TARGETS[target])


WRONG = {
    "target": (("ggx", "maya", "-o", "a.py"), "no target 'maya'"),
    "no target": (("ggx",), "Name a target to export ggx to: "),
    "name": (("ggx", "pbrt", "-o", "a\udcff.pbrt"), "bytes that are no UTF-8"),
    "line": (("ggx", "pbrt", "-o", "a\nb.pbrt"), "ab.pbrt: its name has control characters"),
    "suffix": (("ggx", "python", "-o", "a.txt"), "is written as .py; choose a.py"),
    "no name": (("ggx", "python", "-o", ""), "is written as .py; choose material.py"),
    "measured": (("car_paint", "python", "-o", "a.py"), "was measured; fit a model to it first"),
    "damaged": (("damaged.json", "python", "-o", "a.py"), "damaged.json"),
    "foreign": (("foreign.json", "python", "-o", "a.py"), "foreign.json"),
    "folder": (("ggx", "python", "-o", "none/a.py"), "there is no folder"),
    "protected": (("ggx", "python", "-o", "/proc/a.py"), "/proc/a.py"),
    "existing": (("ggx", "python", "-o", "kept.py"), "exists already"),
}


@pytest.mark.parametrize("case", WRONG)
def test_an_error_is_a_sentence(case, cli, tmp_path):
    words, says = WRONG[case]
    (tmp_path / "damaged.json").write_text('{"model": ')
    (tmp_path / "foreign.json").write_text('{"asset": {"version": "2.0"}}')
    (tmp_path / "kept.py").write_text("x = 1\n")
    status, output = cli("export", *words)
    assert status == 2
    assert says in " ".join(output.split())
    assert "Traceback" not in output
    assert sorted(p.name for p in tmp_path.iterdir()) == ["damaged.json", "foreign.json", "kept.py"]


SECOND = {
    "blender": "ggx.blend",
    "mitsuba": "ggx_rgb.bsdf",
    "openmaterial": "ggx_brdf.xompt",
    "pbrt": "ggx_spec.bsdf",
}


@pytest.mark.parametrize(("target", "table"), SECOND.items())
def test_another_second_file_is_kept(target, table, cli, tmp_path, monkeypatch):
    monkeypatch.setattr(blender, "_find_blender", lambda: ["false"])
    (tmp_path / table).write_text("measured")
    status, output = cli("export", "ggx", target)
    assert (status, f"{table} exists already" in output) == (2, True)
    assert [path.name for path in tmp_path.iterdir()] == [table]


def test_mitsuba_takes_no_name_for_a_parameter(tmp_path):
    done = bk.export("ggx", "mitsuba", tmp_path / "a$b.xml")
    (bsdf,) = ElementTree.parse(done.paths[0]).getroot()
    assert bsdf[0].get("value") == done.paths[1].name == "a_b_rgb.bsdf"


def test_only_exportable_models_are_ranked(cli, tmp_path):
    angles = np.stack(np.meshgrid(np.arange(0, 80, 10), 0, np.arange(0, 80, 10), (0, 90, 180)))
    values = make_fit("metal").eval(
        *from_angles(*np.radians(angles).reshape(2, 2, -1).swapaxes(0, 1))
    )
    bk.save(bk.Measured.from_angles(*angles.reshape(4, -1), values), tmp_path / "few.csv")
    status, output = cli("fit", "few.csv", "-m", "best", "--exportable", "blender", "--json")
    assert status == 0
    models = [row["model"] for row in json.loads(output)["ranking"]["models"]]
    coloured = "ggx:fresnel=coloured"
    assert {*models} == {"ggx", "ggx+ggx", "lambert", coloured, f"{coloured}+{coloured}"}
    assert cli("fit", "few.csv", "-m", "ward", "--exportable", "blender")[0] == 2


def test_weights_in_a_spectrum_become_rgb_where_they_must(tmp_path):
    model = bk.models()["ggx"](wavelengths=[450, 550, 650], diffuse_reflectance=[0.1, 0.2, 0.3])
    done = bk.export(model, "python", tmp_path / "a.py")
    assert done.changes == ("3 wavelengths became linear sRGB",)
    assert "(3 wavelengths became linear sRGB: log error 0, mean ΔE 0)" in str(done)
    assert "Lost: 3 wavelengths became linear sRGB" in done.paths[0].read_text()
    blue = model.changed(diffuse_reflectance=[0.5, 0, 0])  # in sRGB, its red is below 0
    done = bk.export(blue, "python", tmp_path / "b.py", accept_loss=True)
    assert done.log_error > 0.01
    done = bk.export(model, "openmaterial", tmp_path / "a.xomp")
    assert done.changes == ("interpolated between angles",)
    assert json.loads(done.paths[1].read_text())["brdf"]["wavelengths"] == [4.5e-7, 5.5e-7, 6.5e-7]


@pytest.mark.parametrize("target", ["python", "blender"])
def test_a_name_in_a_file_becomes_no_code(target, tmp_path):
    fit = bk.fit("red_plastic", "lambert")
    harm = '"""\nraise SystemExit(3)\n"""\u2028raise SystemExit(3)\r'
    file = tmp_path / "a.py"
    bk.export(replace(fit, data=harm), target, file)
    tree = ast.parse(file.read_text())
    assert not [node for node in ast.walk(tree) if isinstance(node, ast.Raise)]


@pytest.mark.parametrize("target", ["materialx", "mitsuba", "usd"])
def test_a_name_in_a_file_ends_no_comment(target, tmp_path):
    fit = bk.fit("red_plastic", "lambert")
    file = tmp_path / f"a{TARGETS[target].suffix}"
    bk.export(replace(fit, data="---> --><harm/> \uffff\n<harm/>"), target, file)
    text = file.read_text(encoding="utf-8")
    assert "harm" in text
    if target == "usd":
        assert all(line.startswith("# ") for line in text.splitlines() if "harm" in line)
    else:
        assert "harm" not in {node.tag for node in ElementTree.fromstring(text).iter()}


def test_a_bsdf_of_mitsuba_is_refused():
    with pytest.raises(BrdfkitError, match="is no fit and no model of brdfkit"):
        bk.export({"type": "diffuse"}, "python", "a.py")
