"""The command line: every command × what people type, right and wrong."""

import json
import os
import re
import resource
import signal
import subprocess
import sys
import time
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np
import OpenEXR
import pytest
from click.testing import CliRunner
from PIL import Image
from rich.cells import cell_len
from small_files import merl
from user_model import USER_MODEL

import brdfkit as bk
from brdfkit.cli import main
from brdfkit.core import catalogue
from brdfkit.core.discovery import plugin_files
from brdfkit.distance_fields import sphere
from brdfkit.rendering.scenes import scene_names
from brdfkit.rendering.volumes.scene import RENDERERS
from brdfkit.volumes.transfer.files import list_presets

SMALL = ("--size", "16", "--spp", "2")
SHAPE = (6, 4, 8)
CELLS = 3 * np.prod(SHAPE)
SCENE = """<scene version="3.0.0">
    <integrator type="path"/>
    <sensor type="perspective">
        <transform name="to_world"><lookat origin="0,0,4" target="0,0,0" up="0,1,0"/></transform>
        <film type="hdrfilm"><integer name="width" value="8"/><integer name="height" value="6"/>
        </film>
    </sensor>
    <emitter type="constant"/>
    <shape type="sphere">
        <bsdf type="ward"><float name="alpha_u" value="{alpha}"/></bsdf>
    </shape>
</scene>"""


@pytest.fixture
def here(tmp_path, monkeypatch):
    """An empty current folder with a measured file in it."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(plugin_files, "_users", {})
    Path("paint.binary").write_bytes(merl(SHAPE))
    return tmp_path


@pytest.fixture
def cli(here, llvm_variant):
    """A function that runs the command line in `here`, which gives its status and output."""
    return lambda *words: CliRunner().invoke(main, [str(w) for w in words])


def tree(folder):
    return sorted(str(p.relative_to(folder)) for p in folder.rglob("*"))


def assert_fine(result):
    assert result.exit_code == 0, result.output
    assert result.stderr == ""


# What works


@pytest.mark.quick
def test_models(cli):
    listed = cli("models")
    assert_fine(listed)
    assert all(name in listed.stdout for name in bk.models())
    as_json = json.loads(cli("models", "--json").stdout)
    assert list(as_json) == list(bk.models())


@pytest.mark.quick
def test_page_of_a_model(cli, model):
    name = model.type_name()
    page = cli("models", name)
    assert_fine(page)
    assert all(word in page.stdout for word in [*model.parameters, f'"type": "{name}"'])
    assert all(word in page.stdout for word in model.options)
    record = json.loads(cli("models", name, "--json").stdout)[name]
    for parameter, found in model.parameters.items():
        assert record[parameter]["default"] == found.default
        finite = [None if np.isinf(bound) else bound for bound in found.bounds]
        assert record[parameter]["bounds"] == finite


@pytest.mark.quick
def test_info(cli):
    listed = cli("info")
    assert_fine(listed)
    assert all(name in listed.stdout for name in catalogue.list_materials())
    shown = cli("info", "paint.binary")
    assert_fine(shown)
    assert "6×4×8 table" in shown.stdout
    record = json.loads(cli("info", "paint.binary", "--json").stdout)
    data = bk.load("paint.binary")
    assert record["shape"] == list(SHAPE)
    assert record["size"] == np.prod(SHAPE)
    assert record["valid"] == data.samples.valid.sum()
    assert record["largest"] == data.values[data.samples.valid].max()
    assert record["info"] == data.info


def test_info_with_a_picture(cli):
    result = cli("info", "paint.binary", "-o", "paint.png")
    assert_fine(result)
    assert result.stdout.endswith("written: paint.png\n")
    assert Path("paint.png").read_bytes().startswith(b"\x89PNG")
    assert_fine(cli("info", "paint.binary", "-o", "paint.svg", "-q"))
    assert "<svg" in Path("paint.svg").read_text()


def test_fit(cli):
    result = cli("fit", "paint.binary", "-m", "lambert", "-m", "ward", "-o", "out", "--json")
    assert_fine(result)
    record = json.loads(result.stdout)
    assert tree(Path("out")) == ["lambert.json", "ward.json"]
    assert sorted(record["written"]) == ["out/lambert.json", "out/ward.json"]
    assert [f["error"] for f in record["fits"]] == sorted(f["error"] for f in record["fits"])
    for fit in record["fits"]:
        saved = bk.load(f"out/{fit['model']}.json")
        assert fit["error"] == pytest.approx(saved.loss)
        assert fit["error"] == pytest.approx(fit["errors"][fit["loss"]])
        assert fit["parameters"].keys() == fit["standard_errors"].keys() == saved.values.keys()
        assert fit["degrees_of_freedom"] == saved.degrees_of_freedom
        assert fit["bic"] == saved.bic
        assert fit["albedos"] == pytest.approx(np.mean(saved.albedo.fit[:3], axis=1))
        assert fit["notes"] == list(saved.notes)
    assert record["measured_albedo"] == pytest.approx(list(bk.load("paint.binary").albedo.means))
    saved_fits = [bk.load(file) for file in record["written"]]
    printed = cli("fit", "paint.binary", "-m", "lambert", "-m", "ward").stdout
    assert str(bk.compare("paint.binary", saved_fits)) in printed


UNDEFINED_MODEL = '''"""Fog: not a number at normal incidence."""

import drjit as dr

from brdfkit.model import Model, shape, weight
from brdfkit.model.lobes import Cosine, Lobe


class Fog(Model):
    reflectance = weight(0.3, "k")
    p = shape(0.5, (0.1, 2.0), "p")

    def lobes(self):
        return (Lobe(lambda wi, wo: dr.sqrt(self.p * (0.5 - wi.z)), Cosine()),)
'''


def test_render_a_scene_with_plugins_of_ones_own(cli):
    Path("my/bsdfs").mkdir(parents=True)
    Path("my/bsdfs/felt.py").write_text(USER_MODEL)
    scene = SCENE.replace("ward", "felt").replace("alpha_u", "diffuse_reflectance")
    Path("room.xml").write_text(scene.format(alpha=0.3))
    alone = cli("render", "room.xml", "--spp", "1")
    assert (alone.exit_code, alone.stdout) == (2, "")
    assert "room.xml" in alone.stderr
    assert_fine(cli("render", "room.xml", "--spp", "1", "--plugins", "my"))


def test_a_model_that_cannot_be_fitted_does_not_stop_the_others(cli):
    Path("fog.py").write_text(UNDEFINED_MODEL)
    models = "-m", "fog.py", "-m", "lambert"
    result = cli("fit", "paint.binary", *models, "-o", "out", "--json")
    assert result.exit_code == 2
    assert result.stderr.startswith("brdfkit: fog: the lobe of reflectance is nan at theta_i")
    assert tree(Path("out")) == ["lambert.json"]
    record = json.loads(result.stdout)
    assert [f["model"] for f in record["fits"]] == ["lambert"]
    assert list(record["failed"]) == ["fog"]
    alone = cli("fit", "paint.binary", "-m", "fog.py", "-o", "new")
    assert (alone.exit_code, alone.stdout, alone.stderr) == (2, "", result.stderr)
    assert not Path("new").exists()


def test_fit_and_render(cli):
    result = cli("fit", "paint.binary", "-m", "lambert", "-m", "lambert", "--render", *SMALL)
    assert_fine(result)
    assert tree(Path("paint")) == ["lambert.json", "render.exr", "render.png"]
    assert "PSNR" in result.stdout
    assert result.stdout.count("written:") == 3


def test_a_folder_may_have_the_name_of_a_material(cli):
    """`fit car_paint --render` makes such a folder; the next `fit car_paint` reads the table."""
    name = next(iter(catalogue.list_materials()))
    Path(name).mkdir()
    Path("ward").mkdir()
    assert_fine(cli("info", name))
    assert_fine(cli("render", "ward", *SMALL))


@pytest.mark.parametrize(
    ("words", "names"),
    [
        (["ward", "-p", "alpha_u=0.1", "-p", "diffuse_reflectance=.4,.2,.1"], ["ward"]),
        (["paint.binary", "lambert"], ["paint", "lambert"]),
        (["ward", "ward"], ["ward", "ward (2)"]),
    ],
)
def test_render(cli, words, names):
    result = cli("render", *words, *SMALL, "-o", "it.exr", "--json")
    assert_fine(result)
    record = json.loads(result.stdout, parse_constant=pytest.fail)  # neither inf nor nan
    assert record["pictures"] == names
    assert record["spp"] == 2
    assert record["written"] == ["it.exr", "it.png"]
    assert list(record["psnr"]) == list(record["errors"]["by_name"]) == names[1:]
    assert record["errors"]["floor"]["psnr"] > 10
    assert {"it.exr", "it.png"} < set(tree(Path()))


@pytest.mark.quick
def test_render_by_a_tone_mapping(cli):
    """The PNG shows it, of materials and scenes, the EXR has the same numbers."""
    Path("room.xml").write_text(SCENE.format(alpha=0.3))
    for words in (["ward", *SMALL], ["room.xml", "--spp", "1"]):
        for name, tone in (("it", ()), ("dark", ("--tone-mapping", "reinhard", "--exposure", "0"))):
            assert_fine(cli("render", *words, *tone, "-o", f"{name}.exr", "--force"))
        linear = [OpenEXR.File(f"{n}.exr").channels()["RGB"].pixels for n in ("it", "dark")]
        np.testing.assert_allclose(*linear, rtol=1e-4)
        assert Path("it.png").read_bytes() != Path("dark.png").read_bytes()
    wrong = cli("render", "ward", *SMALL, "--tone-mapping", "reinhart", "-o", "wrong.png")
    assert wrong.exit_code == 2
    assert "did you mean reinhard" in wrong.stderr
    assert not Path("wrong.png").exists()


def test_render_until_the_noise_is_low(cli):
    Path("room.xml").write_text(SCENE.format(alpha=0.3))
    for words in (["ward", "--size", "8"], ["room.xml"]):
        record = json.loads(cli("render", *words, "--noise-floor", "30dB", "--json").stdout)
        assert record["errors"]["floor"]["psnr"] >= 30
    few = "--size", "8", "--spp", "4", "--noise-floor", "60 dB", "--force"
    result = cli("render", "ward", "lambert", *few)
    assert result.exit_code == 0
    assert re.search(r"The noise floor is .* dB; 60 dB take about [\d,]+ samples", result.stderr)
    assert re.search(r"\n lambert .*\n noise floor ", result.stdout, re.DOTALL)
    alone = cli("render", "ward", *few)
    assert "The noise floor is" in alone.stderr
    assert "The noise floor is" not in alone.stdout


def test_render_a_volume(cli):
    """By a renderer of it, with its parameters, by a tone mapping; what is meant for other things
    is refused."""
    words = "smoke", "--renderer", "isosurface", "--set", "level=0.4", "--set", "shadows=false"
    result = cli("render", *words, "--set", "bsdf=lambert", *SMALL, "-o", "it.exr", "--json")
    assert_fine(result)
    record = json.loads(result.stdout)
    assert record["pictures"] == ["smoke"]
    assert record["spp"] == 2
    header = OpenEXR.File("it.exr").header()
    assert json.loads(header["parameters"])["level"] == 0.4
    assert all(name in cli("render", "--help").stdout for name in (*RENDERERS, *list_presets()))
    assert_fine(cli("render", "sphere", "--tone-mapping", "filmic", "--azimuth", "0", *SMALL))
    assert Path("sphere.png").exists()
    by_scan = cli("render", "sphere", "--transfer", "ct_bone", *SMALL, "--force")
    assert by_scan.exit_code == 0
    assert "ct_bone is for HU" in by_scan.stderr
    for words, said in (
        (["smoke", "--renderer", "isosurfac"], "did you mean isosurface?"),
        (
            ["smoke", "--set", "level"],
            "--set 'level' should read level=VALUE; repeat --set for more.",
        ),
        (["smoke", "--density", "0"], "density = 0.0 should be a number above 0."),
        (["smoke", "ward"], "smoke is a volume, which is rendered alone"),
        (["smok"], "did you mean smoke?"),
        (
            ["smoke", "--renderer", "isosurface", "--set", "level=30"],
            "level = 30 is outside the values of smoke, 0 to 1",
        ),
        (["smoke", "--scene", "knot"], "leave --scene and --preview out"),
        (["ward", "--transfer", "ct_bone"], "--transfer is for volumes only"),
    ):
        result = cli("render", *words, *SMALL, "-o", "wrong.png")
        assert result.exit_code == 2
        assert said in result.stderr
        assert not Path("wrong.png").exists()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("a.binary", "ggx"), "ggx is a model, not a file: write -m ggx."),
        (("a.binary", "-m", "ggx", "ward"), "ward is a model, not a file: write -m ward."),
        (("a.binary", "-m", "ggx,ward"), "repeat -m: -m ggx -m ward."),
    ],
)
def test_models_among_files(cli, words, said):
    """A model in the place of a file, and several in one -m, are refused before anything is fit."""
    result = cli("fit", *words)
    assert result.exit_code == 2
    assert said in result.stderr


def test_decimal_comma(cli):
    """A comma in the place of a point is told of."""
    result = cli("render", "ggx", "--set", "alpha_u=0,3", *SMALL)
    assert result.exit_code == 2
    assert "Decimals take a point: alpha_u=0.3." in result.stderr


def test_render_in_another_scene(cli):
    """A scene file keeps its size, unless another is given; the help names every scene."""
    scene = SCENE.format(alpha=0.3).replace('"ward"', '"ward" id="it"')
    Path("room.xml").write_text(scene)
    for words, shape in (((), (6, 8)), (("--size", "5"), (5, 5))):
        words = *words, "--spp", "1", "--scene", "room.xml#it", "-o", "it.exr", "--force"
        assert_fine(cli("render", "lambert", *words))
        assert OpenEXR.File("it.exr").channels()["RGB"].pixels.shape[:2] == shape
    assert_fine(cli("render", "lambert", *SMALL, "--scene", "cornell_box"))
    shown = cli("render", "--help").stdout
    assert all(name in shown for name in scene_names())


def test_render_a_scene_a_fit_and_a_field(cli):
    Path("room.xml").write_text(SCENE.format(alpha=0.3))
    assert_fine(cli("fit", "paint.binary", "-m", "ward", "-o", "."))
    sphere(1).save("ball.json")
    files = (["room.xml"], ["ward.json", *SMALL], ["ball.json", "--size", "8"])
    for words, made in zip(files, ("room.png", "ward.png", "ball.png"), strict=True):
        result = cli("render", *words, "--spp", "1")
        assert_fine(result)
        assert f"written: {made}" in result.stdout
        assert Path(made).exists()


@pytest.mark.quick
@pytest.mark.parametrize(("words", "spp"), [([], 7), (["--spp", "3"], 3), (["--spp", "64"], 64)])
def test_a_scene_has_its_own_samples_per_pixel(cli, words, spp):
    sampler = '<sampler type="independent"><integer name="sample_count" value="7"/></sampler>'
    Path("room.xml").write_text(SCENE.format(alpha=0.3).replace("<film", f"{sampler}<film"))
    result = cli("render", "room.xml", *words, "--json")
    assert_fine(result)
    assert json.loads(result.stdout)["spp"] == spp


def test_check(cli):
    Path("felt.py").write_text(USER_MODEL)
    result = cli("check", "lambert", "felt.py", "--json")
    assert_fine(result)
    reports = json.loads(result.stdout)
    assert [r["name"] for r in reports] == ["lambert", "felt"]
    assert all(r["passed"] is True for r in reports)
    assert all(f["passed"] is True for r in reports for f in r["findings"])


def test_a_file_stands_for_the_model_in_it(cli):
    """Wherever a model is named; then a saved fit of it is known, too."""
    Path("c++").mkdir()
    Path("c++/felt.py").write_text(USER_MODEL)
    assert "Felt: dull." in cli("models", "c++/felt.py").stdout
    Path("felt.py").write_text(USER_MODEL.replace("0.3", "0.2"))
    plugin_files._users.clear()
    assert_fine(cli("fit", "paint.binary", "-m", "felt.py", "-m", "felt.py+ward", "-o", "."))
    assert {"felt.json", "felt+ward.json"} < set(tree(Path()))
    assert_fine(cli("render", "felt.py", "felt.json", "felt+ward.json", *SMALL))
    assert_fine(cli("convert", "felt.py", "felt.bsdf"))
    plugin_files._users.clear()
    unknown = cli("render", "felt.json", *SMALL)
    assert unknown.exit_code == 2
    assert "'felt', a model of somebody's own; load its file first" in unknown.stderr


@pytest.mark.quick
def test_check_fails_with_status_1(cli, monkeypatch):
    from brdfkit.checks.registry import checks

    monkeypatch.setitem(checks, "bsdfs", {"energy": lambda subject: (np.False_, "all")})
    result = cli("check", "lambert")
    assert result.exit_code == 1
    assert "FAIL" in result.stdout
    assert json.loads(cli("check", "lambert", "--json").stdout)[0]["passed"] is False
    assert checks


@pytest.mark.parametrize(
    "words",
    [
        ["models"],
        ["models", "ward"],
        ["info"],
        ["info", "paint.binary"],
        ["fit", "paint.binary", "-m", "lambert"],
        ["render", "lambert", *SMALL],
    ],
    ids=" ".join,
)
def test_quiet_prints_nothing_but_json(cli, words):
    result = cli(*words, "--quiet")
    assert_fine(result)
    assert result.stdout == ""
    result = cli(*words, "--quiet", "--json")
    assert_fine(result)
    assert json.loads(result.stdout)


@pytest.mark.quick
def test_a_name_is_no_markup(cli):
    for name in ("[bold]a.binary", "a :car: b.binary"):
        Path(name).write_bytes(merl(SHAPE))
        result = cli("info", name)
        assert_fine(result)
        assert Path(name).stem in result.stdout


# names that a file may bring, and the name of what is made of it
NAMES = {
    "../evil": "-evil",
    "/no/evil": "-no-evil",
    "..": "material",
    "": "material",
    "a/b\\c:d": "a-b-c-d",
    "red\x1b]0;evil\x07\x9b2J": "red]0;evil2J",
    "null\0": "null",
    "x" * 300: "x" * 100,
    "漆" * 100: "漆" * 33,
    "Lack, grün (2)": "Lack, grün (2)",
}


@pytest.mark.parametrize("name", NAMES)
def test_a_name_from_a_file_stays_here_and_off_the_terminal(cli, here, name):
    """As it comes out of a file: nothing of brdfkit's would write such a name."""
    notes = {"made\x1b[2J by": "a\x1b[2J\nb"}
    material = replace(bk.load("paint.binary"), name=name, info=notes)
    Path("in").mkdir()
    bk.save(material, "in/it.npz")
    before = tree(here.parent)
    shown, rendered = cli("info", "in/it.npz"), cli("render", "in/it.npz", *SMALL)
    fitted = cli("fit", "in/it.npz", "-m", "lambert", "--render", *SMALL)
    for result in (shown, rendered, fitted):
        assert_fine(result)
        assert not re.search(r"[^\n -~\xa0-\U0010ffff]", result.stdout)
    made = {f"{NAMES[name]}.png", *(f"{NAMES[name]}/{f}" for f in FITTED), NAMES[name]}
    assert set(tree(here.parent)) - set(before) == {f"{here.name}/{file}" for file in made}


FITTED = "lambert.json", "render.exr", "render.png"


@pytest.mark.quick
def test_an_error_is_printed_without_control_characters(cli):
    Path("a.astm").write_text("VARS theta_i,phi_i,theta_s,phi_s,\x1b[2J,B\n1,0,1,0,1,1\n")
    result = cli("info", "a.astm")
    assert result.exit_code == 2
    assert "names the channels [2J, B" in result.stderr


# What does not work: one sentence that names the culprit, status 2, nothing left behind

FILES = {
    "short.binary": merl(SHAPE)[:-5],
    "long.binary": merl(SHAPE) + b"more",
    "dimensions.binary": merl((0, 0, 0), raw=[]),
    "huge.binary": merl(SHAPE).replace(merl(SHAPE)[:12], b"\xff\xff\xff\x7f" * 3),
    "nan.binary": merl(SHAPE, raw=np.full(CELLS, np.nan)),
    "invalid.binary": merl(SHAPE, raw=np.full(CELLS, -1.0)),
    "empty.binary": b"",
    "notes.foo": b"hello",
    "fit.json": b"{",
    "broken.xml": b'<scene version="3.0.0"><bsdf',
    "unknown.xml": b'<scene version="3.0.0"><bsdf type="nope"/></scene>',
    "bounds.xml": SCENE.format(alpha=7).encode(),
    "fails.py": b"1 / 0",
    "empty.py": b"",
    "ward.py": USER_MODEL.encode(),
    "diffuse.py": USER_MODEL.encode(),
}
WARD = "render", "ward"
LAMBERT = "fit", "paint.binary", "-m", "lambert"
TRAPS = [
    # words typed, words that the sentence has to hold
    *[(["info", name], [name]) for name in FILES if Path(name).suffix in (".binary", ".foo")],
    *[(["fit", name, "-o", "new"], [name]) for name in ("short.binary", "nan.binary")],
    *[(["render", name], [name]) for name in FILES if Path(name).suffix == ".xml"],
    *[(["check", name], [name]) for name in FILES if Path(name).suffix == ".py"],
    (["render", "unknown.xml"], ["nope"]),
    (["render", "bounds.xml"], ["ward: alpha_u = 7", "between 0.001 and 1"]),
    (["info", "fit.json"], ["fit.json"]),
    (["info", "-o", "a.png"], ["name a FILE"]),
    (["info", "paint.binary", "-o", "a.exr"], ["a.exr", ".png, .pdf, .svg"]),
    (["info", "paint.binary", "-o", "no/a.png"], ["no/a.png", "create it"]),
    (["info", "missing.binary"], ["missing.binary", "no such file"]),
    (["info", "."], ["folder"]),
    (["info", "studoi"], ["no file or environment map 'studoi'", "did you mean studio?"]),
    (["fit", "plaster", "ggx"], ["ggx is a model, not a file", "-m ggx"]),
    (["render", "spot.obj"], ["spot.obj is a mesh", "--scene spot.obj"]),
    ([*WARD, "--shadows"], ["--shadows is for --preview"]),
    ([*WARD, "--up", "z"], ["--up turns a mesh, .obj or .ply; leave it out for ball"]),
    (["render", "missing.xml"], ["missing.xml"]),
    (["render", "nothing"], ["nothing", "ward", "car_paint"]),
    (["render", "bounds.xml", "ward"], ["alone"]),
    (["render", "bounds.xml", "--scene", "vase"], ["bounds.xml", "leave --set, --scene"]),
    (["render", "bounds.xml", "--size", "9"], ["bounds.xml", "leave", "--size"]),
    (["render", "bounds.xml#wall"], ["bounds.xml#wall is a place", "as --scene bounds.xml#wall"]),
    ([*WARD, "--envmap", ""], ["environment map = '' should be the path of a file"]),
    ([*WARD, "--scene", "vaes"], ["vaes", "did you mean vase?", "cornell_box"]),
    ([*LAMBERT, "--render", "--scene", "no.obj", "-o", "new"], ["no.obj", "no such file"]),
    ([*LAMBERT, "--render", "--envmap", "no.exr", "-o", "new"], ["no.exr", "no such file"]),
    *(
        ([*LAMBERT, option, value], [f"{option} is for pictures; add --render"])
        for option, value in (
            ("--scene", "ball"),
            ("--envmap", "sky.exr"),
            ("--spp", "4"),
            ("--noise-floor", "40dB"),
            ("--size", "8"),
        )
    ),
    (["render", "paint.binary", "-p", "alpha_u=.1"], ["paint.binary", "no model"]),
    ([*WARD, "-p", "nope=1"], ["nope", "alpha_u"]),
    ([*WARD, "-p", "alpha_u"], ["alpha_u=VALUE"]),
    ([*WARD, "-p", "alpha_u=x"], ["alpha_u=x"]),
    ([*WARD, "-p", "alpha_u=7"], ["alpha_u = 7", "between 0.001 and 1"]),
    ([*WARD, "-p", "alpha_u=nan"], ["alpha_u = nan", "between 0.001 and 1"]),
    ([*WARD, "-p", "alpha_u=.1,.2,.3"], ["alpha_u", "a number"]),
    ([*WARD, "-p", "diffuse_reflectance=-1"], ["diffuse_reflectance = -1", "at least 0"]),
    ([*WARD, "-p", "diffuse_reflectance=1,2"], ["diffuse_reflectance=R,G,B"]),
    ([*WARD, "--size", "0"], ["--size", "x>=1"]),
    ([*WARD, "--size", "100000"], ["100000×100000", "2,200 GB", "give a smaller size"]),
    (
        [*WARD, "--noise-floor", "loud"],
        ["--noise-floor", "'loud' is no noise floor; give one like 45dB"],
    ),
    ([*LAMBERT, "--render", "--size", "100000"], ["2 pictures of 100000×100000", "smaller size"]),
    ([*WARD, "--spp", "0"], ["--spp", "x>=1"]),
    ([*WARD, "--spp", "many"], ["--spp", "many"]),
    ([*WARD, "--seed", "-1"], ["--seed"]),
    ([*WARD, "-o", "a.tif"], ["a.tif", ".exr or .png"]),
    ([*WARD, "-o", "a"], [".exr or .png"]),
    ([*WARD, "-o", "no/a.png"], ["no/a.png", "create it"]),
    ([*WARD, "-o", "paint.binary/a.png"], ["paint.binary"]),
    (["models", "nope"], ["nope", "ward"]),
    (["models", "nope.py"], ["nope.py", "no Python file"]),
    ([*LAMBERT[:-1], "felt.py", "-o", "new"], ["felt.py", "no Python file"]),
    (["fit", "paint.binary", "-m", "nope", "-o", "new"], ["nope", "ward"]),
    (["fit", "paint.binary", "-m", "measured_table"], ["measured_table"]),
    (["fit", "fit.json"], ["fit.json"]),
    ([*LAMBERT, "--loss", "nope", "-o", "new"], ["nope", "cosine, log"]),
    ([*LAMBERT, "--max-angle", "0", "-o", "new/er"], ["max_angle", "above 0"]),
    ([*LAMBERT, "--max-angle", "300"], ["max_angle = 300", "at most 90"]),
    ([*LAMBERT, "--size", "0", "--render"], ["--size"]),
    ([*LAMBERT, "-o", "paint.binary"], ["paint.binary", "folder"]),
    ([*LAMBERT, "-o", "paint.binary/new"], ["paint.binary/new", "folder"]),
    (["fit"], ["FILE", "fit --help"]),
    (["info", "--xyz"], ["no option '--xyz'; there are --output", "see brdfkit info --help."]),
    (
        [*WARD, "--spx", "3"],
        ["no option '--spx'; did you mean --spp? There are --output", "--seed"],
    ),
    (["nope"], ["no command 'nope'; there are check, complete, convert", "see brdfkit --help."]),
    (["rendr"], ["no command 'rendr'; did you mean render? There are check", "brdfkit --help."]),
    (["data", "gte"], ["no command 'gte'; did you mean get? There are", "brdfkit data --help."]),
    (["--nope"], ["no option '--nope'; there are --version, --help; see brdfkit --help."]),
    (["--versio"], ["did you mean --version?"]),
]


@pytest.mark.quick
@pytest.mark.parametrize(("words", "said"), TRAPS, ids=[" ".join(words) for words, _ in TRAPS])
def test_bad_input(cli, here, words, said):
    for name in set(words) & set(FILES):
        Path(name).write_bytes(FILES[name])
    before = tree(here)
    result = cli(*words)
    assert result.exit_code == 2, result.output
    assert result.stdout == ""
    assert result.stderr.startswith("brdfkit: ")
    assert result.stderr.count("\n") == 1
    assert "Traceback" not in result.stderr
    assert all(word in result.stderr for word in said), result.stderr
    assert [p for p in tree(here) if "__pycache__" not in p] == before


@pytest.mark.quick
def test_help_names_every_loss(cli):
    described = cli("fit", "--help").stdout
    assert all(re.search(rf"\b{loss}\b", described) for loss in bk.losses.named)


def test_ctrl_c_keeps_the_finished_fits(cli, monkeypatch):
    fitted = bk.fit

    def interrupted(material, name, **options):
        if name == "ward":
            raise KeyboardInterrupt
        return fitted(material, name, **options)

    monkeypatch.setattr("brdfkit.fitting.fit.fit", interrupted)
    words = "fit", "paint.binary", "-m", "lambert", "-m", "ward", "-o", "out", "--render"
    result = cli(*words)
    assert result.exit_code == 130
    assert result.stderr == "brdfkit: interrupted; 1 of 2 fits are finished.\n"
    assert "lambert fitted to paint" in result.stdout
    assert tree(Path("out")) == ["lambert.json"]
    first = cli("fit", "paint.binary", "-m", "ward", "-o", "new")
    assert (first.exit_code, first.stderr) == (130, "brdfkit: interrupted.\n")
    assert not Path("new").exists()


def test_ctrl_c_keeps_the_passes_of_a_picture_and_says_so(cli, monkeypatch):
    monkeypatch.setattr("brdfkit.rendering.tracing.PASS", 1)
    monkeypatch.setattr("brdfkit.cli.console.Console.progress", interrupting)
    said = "brdfkit: interrupted; rendered with 2 of 5 samples per pixel.\n"
    Path("room.xml").write_text(SCENE.format(alpha=0.3))
    for words in (["ward", "--size", "8"], ["room.xml"]):
        result = cli("render", *words, "--spp", "5", "-o", "it.png", "--force")
        assert (result.exit_code, result.stderr) == (130, said)
        assert "2 spp" in result.stdout
        assert "written: it.png" in result.stdout
    words = "--render", "--size", "8", "--spp", "5", "-o", "out"
    monkeypatch.setattr(
        "brdfkit.rendering.tracing.PASS", 2
    )  # two materials: every pass counts twice
    result = cli("fit", "paint.binary", "-m", "lambert", *words)
    assert (result.exit_code, result.stderr) == (130, said)
    assert "written: out/render.png" in result.stdout
    assert "paint: errors of pictures" in result.stdout


@contextmanager
def interrupting(console, what):
    """A progress that types Ctrl-C once two passes are done."""

    def progress(done, total):
        if what == "render" and done == 2:
            raise KeyboardInterrupt

    yield progress


WRITES_ITS_SECOND_FIT = """
import os, time
from brdfkit.cli import main

replace, written = os.replace, []

def slow(source, target):
    if written:
        print("writing", flush=True)
        for _ in range(6000):  # a signal just before one long sleep would take effect after it
            time.sleep(0.1)
    written.append(target)
    replace(source, target)

os.replace = slow
main(["fit", "paint.binary", "-m", "lambert", "-m", "phong", "-o", "out"])
"""


@pytest.mark.parametrize("received", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_a_command_cleanly(here, received):
    """In a process of its own, while it writes a file."""
    command = [sys.executable, "-c", WRITES_ITS_SECOND_FIT]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    with subprocess.Popen(command, text=True, cwd=here, **pipes) as process:
        assert process.stdout.readline() == "writing\n"
        assert [name for name in tree(Path("out")) if name.startswith(".brdfkit-")]
        process.send_signal(received)
        printed, told = process.communicate(timeout=300)
    assert process.returncode == 128 + received
    assert told == "brdfkit: interrupted; 1 of 2 fits are finished.\n"
    assert "lambert fitted to paint" in printed
    assert tree(Path("out")) == ["lambert.json"]


@pytest.mark.quick
def test_after_a_command_a_signal_does_what_it_did_before(cli):
    before = signal.getsignal(signal.SIGTERM)
    assert_fine(cli("models"))
    assert signal.getsignal(signal.SIGTERM) is before


# The picture of a folder


def test_a_gallery_shows_a_ball_of_each_and_names_the_others(cli):
    folder = Path("folder")
    folder.mkdir()
    for name in ("b.npz", "a.npz"):
        bk.save(bk.Measured.from_table(np.full((2, 2, 2, 3), 0.1), name=name[0]), folder / name)
    (folder / "notes.txt").write_text("none")
    shown = cli("gallery", folder, "ggx", "-o", "sheet.png", "--size", "32", "--json")
    assert shown.exit_code == 0, shown.output
    said = json.loads(shown.stdout)
    assert said["materials"] == ["a", "b", "ggx"]
    assert list(said["skipped"]) == [str(folder / "notes.txt")]
    assert "notes.txt" in shown.stderr
    with Image.open("sheet.png") as sheet:
        assert sheet.width > 3 * 32
    alone = cli("gallery", folder / "notes.txt", "-o", "none.png")
    assert alone.exit_code == 2
    assert not Path("none.png").exists()


# Tables at all widths

TABLES = [
    ["models"],
    ["models", "ward"],
    ["models", "koenderink"],
    ["models", "mixture"],
    ["info"],
    ["info", "paint.binary"],
    ["data"],
    ["data", "list", "merl"],
    ["data", "list", "rgl"],
    ["data", "list", "cornell"],
]


@pytest.mark.quick
@pytest.mark.parametrize("words", TABLES, ids=" ".join)
def test_no_word_of_a_table_is_lost(cli, monkeypatch, words):
    def printed(columns):
        monkeypatch.setenv("COLUMNS", str(columns))
        result = cli(*words)
        assert_fine(result)
        return result.stdout

    expected = set(re.findall(r"[^\s:─]+", printed(500)))
    for columns in (40, 60, 80, 120):
        shown = printed(columns)
        assert "…" not in shown
        assert expected - set(re.findall(r"[^\s:─]+", shown)) == set()


LONG = "a-word-of-a-length-that-is-rare"
COLUMNS = "model", ">PSNR [dB]", "", "what it is"
ROWS = [
    ("漆 with a long name (2)", "123.456789", "to download", LONG),
    ("ward", "", "here", "[bold]no markup[/bold] :car:"),
    ("", "1", "", ""),
]
BLOCK = """
model: ward
  PSNR [dB]: -
  here
  what it is: [bold]no
    markup[/bold] :car:
"""


@pytest.mark.quick
@pytest.mark.parametrize("columns", [30, 40, 80, 81, 82, 83, 84, 120])
def test_a_table_is_one_or_a_block_for_each_row(monkeypatch, capsys, columns):
    from brdfkit.cli.console import Console

    monkeypatch.setenv("COLUMNS", str(columns))
    Console().print_table(COLUMNS, ROWS[:2], ROWS[2:], title="an [important] table")
    shown = capsys.readouterr().out
    words = {word for row in (COLUMNS, *ROWS) for text in row for word in text.lstrip(">").split()}
    assert {word.strip(":") for word in words} <= {word.strip(":") for word in shown.split()}
    assert "an [important] table" in shown
    assert "…" not in shown
    assert ("───" in shown) == (columns >= 83)
    assert columns != 30 or BLOCK in shown
    assert max(map(cell_len, shown.splitlines())) <= max(columns, len(f"    {LONG}"))


@pytest.mark.quick
@pytest.mark.parametrize(("columns", "is_table"), [(80, True), (60, True), (40, False)])
def test_a_long_name_does_not_undo_a_table(monkeypatch, capsys, columns, is_table):
    """It goes on below; every other row stays one line, and nothing is lost."""
    from brdfkit.cli.console import Console

    monkeypatch.setenv("COLUMNS", str(columns))
    name = "measured-on-a-day-in-" * 5
    rows = [(name, "1.234", "37.1 dB", "take it"), ("ggx", "2.345", "36.2 dB", "tied")]
    Console().print_table(("model", ">error", ">PSNR [dB]", "verdict"), rows)
    shown = capsys.readouterr().out
    assert ("───" in shown) == is_table
    if is_table:
        assert max(map(cell_len, shown.splitlines())) <= columns
        assert name in re.sub(r"\s|1\.234|37\.1 dB|take it", "", shown)
        assert any({"ggx", "2.345", "tied"} <= set(line.split()) for line in shown.splitlines())
    else:
        assert name in shown


# The bar


class Terminal:
    """Takes what is written, as a terminal."""

    encoding = "utf-8"

    def __init__(self):
        self.text = ""

    def write(self, text):
        self.text += text

    def flush(self):
        pass

    def isatty(self):
        return True


@pytest.mark.quick
@pytest.mark.parametrize(("patience", "quiet"), [(0.01, False), (0.01, True), (60, False)])
def test_progress_shows_after_a_second_and_goes_away(monkeypatch, patience, quiet):
    from brdfkit.cli.console import Console

    terminal = Terminal()
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setattr("sys.stderr", terminal)
    monkeypatch.setattr("brdfkit.core.progress_bar.DELAY", patience)
    with Console(quiet=quiet).progress("fit [ward]") as report:
        time.sleep(0.1)
        report(1, 4)
        time.sleep(0.2)
    shown = patience < 1 and not quiet
    assert ("fit [ward]" in terminal.text) == shown
    # the last thing written wipes the line of the bar
    assert terminal.text.endswith("\x1b[1A\x1b[2K") == shown


# From outside


def run(*words, cwd=None, program="brdfkit", **environment):
    return subprocess.run(
        [Path(sys.executable).with_name(program), *words],
        capture_output=True,
        text=True,
        timeout=300,
        cwd=cwd,
        env={**os.environ, "COLUMNS": "80", **environment},
    )


def test_help_is_instant_and_fits_a_terminal(tmp_path):
    """At most three times the processor time of Python with click alone, which is 0.04 s here.

    The best of five: other tests run beside. Bytecode is kept, as for users.
    """
    kept = {"PYTHONDONTWRITEBYTECODE": "", "PYTHONPYCACHEPREFIX": str(tmp_path)}
    alone, helping = [], []
    for _ in range(5):
        alone.append(_used(lambda: run("-c", "import click", program="python", **kept)))
        helping.append(_used(lambda: run("--help", **kept)))
    helped = run("--help", **kept)
    assert helped.returncode == 0
    assert min(helping) <= 3 * min(alone)
    assert "..." not in helped.stdout.partition("Commands:")[2]
    assert max(map(len, helped.stdout.splitlines())) <= 80


def _used(function):
    """Processor time of the processes that `function` starts and waits for [s]."""
    began = resource.getrusage(resource.RUSAGE_CHILDREN)
    function()
    ended = resource.getrusage(resource.RUSAGE_CHILDREN)
    return ended.ru_utime + ended.ru_stime - began.ru_utime - began.ru_stime


@pytest.mark.quick
def test_a_command_is_a_file():
    files = {file.stem for file in Path(bk.__file__).parent.glob("cli/commands/[!_]*.py")}
    assert set(main.commands) == files == {command.name for command in main.commands.values()}


@pytest.mark.quick
@pytest.mark.parametrize(
    "words", [[], *([c] for c in main.commands)], ids=lambda w: w[0] if w else ""
)
def test_help_imports_nothing_heavy(words):
    heavy = {"mitsuba", "drjit", "scipy", "numpy", "rich", "matplotlib"}
    code = f"""
import sys
from brdfkit.cli import main
main({words} + ["--help"], standalone_mode=False)
assert not {heavy} & set(sys.modules), {heavy} & set(sys.modules)
"""
    helped = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert helped.returncode == 0, helped.stderr
    assert "Usage" in helped.stdout


def test_a_fit_starts_no_library_that_it_does_not_need(tmp_path):
    """Each of these takes as much processor time to import as the fit of a small file takes."""
    heavy = {"mitsuba", "matplotlib", "scipy.stats", "scipy.optimize", "colour", "PIL", "requests"}
    angles = [(i, abs(o), 180 * (o >= 0)) for i in (10, 40) for o in range(-75, 76, 15)]
    lines = [f"{i},0,{o},{phi},{0.1 + 1 / (1 + (i - o) ** 2)}" for i, o, phi in angles]
    (tmp_path / "mine.csv").write_text("\n".join(["theta_i,phi_i,theta_o,phi_o,Y", *lines]))
    code = f"""
import sys
from brdfkit.cli import main
for file in "mine.csv", "plaster":
    main(["fit", file, "-m", "ggx", "-o", "fits", "--force"], standalone_mode=False)
    assert not {heavy} & set(sys.modules), (file, {heavy} & set(sys.modules))
"""
    fitted = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, cwd=tmp_path
    )
    assert fitted.returncode == 0, fitted.stderr
    assert "ggx fitted to plaster" in fitted.stdout


def test_a_preview_starts_no_library_that_it_does_not_need(tmp_path):
    """Importing them took as much processor time as all else that a preview does."""
    heavy = {"matplotlib", "scipy", "colour", "requests", "OpenEXR"}
    code = f"""
import sys
from brdfkit.cli import main
main(["render", "ggx", "--preview", "--size", "32"], standalone_mode=False)
assert not {heavy} & set(sys.modules), {heavy} & set(sys.modules)
"""
    shown = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, cwd=tmp_path
    )
    assert shown.returncode == 0, shown.stderr
    assert (tmp_path / "ggx.png").exists()


def test_program(tmp_path):
    """The installed program, its status, and a terminal that knows ASCII only."""
    page = run("models", "ward", PYTHONIOENCODING="ascii")
    assert (page.returncode, page.stderr) == (0, "")
    assert "alpha_u" in page.stdout
    wrong = run("info", "missing.binary", cwd=tmp_path)
    assert (wrong.returncode, wrong.stdout) == (2, "")
    assert wrong.stderr.startswith("brdfkit: missing.binary: ")
    loop = tmp_path / "loop.png"
    loop.symlink_to(loop)
    wrong = run("render", "ward", "-o", "loop.png", cwd=tmp_path)
    assert (wrong.returncode, wrong.stdout) == (2, "")
    assert wrong.stderr.startswith("brdfkit: loop.png: is a link that leads to itself")
    assert run("--version").stdout.strip() == f"brdfkit, version {bk.__version__}"


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full")
@pytest.mark.parametrize("unbuffered", ["", "1"])
@pytest.mark.parametrize("words", [["models"], ["models", "--json"], ["--help"]], ids=" ".join)
def test_a_disk_that_is_full_is_one_sentence(words, unbuffered):
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            [sys.executable, "-m", "brdfkit", *words],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            env={**os.environ, "PYTHONUNBUFFERED": unbuffered},
        )
    assert done.returncode == 2
    assert re.fullmatch(r"brdfkit: the output cannot be written \(.*\); make room\.\n", done.stderr)


def test_python_knows_the_command_line(tmp_path):
    words = sys.executable, "-m", "brdfkit", "models", "nope"
    done = subprocess.run(words, capture_output=True, text=True, cwd=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith("brdfkit: There is no model 'nope'")


def test_shape_parameters_are_fixed_bounded_and_tied(cli):
    words = "fit", "paint.binary", "-m", "ggx", "--fixed", "f0=0.04", "--bound", "alpha_u=0.3,0.4"
    result = cli(*words, "--isotropic", "--json")
    assert_fine(result)
    (found,) = json.loads(result.stdout)["fits"]
    assert found["parameters"]["f0"] == 0.04
    assert 0.3 <= found["parameters"]["alpha_u"] == found["parameters"]["alpha_v"] <= 0.4
    assert "Nothing was saved; -o FOLDER keeps the fits." in cli(*words).stdout
    for given in (["--fixed", "f0=0.04"], ["--isotropic"]):
        result = cli("render", "ggx", *given)
        assert (result.exit_code, result.stderr.count("\n")) == (2, 1)
        assert f"{given[0]} is for brdfkit fit and report, and render fits nothing" in result.stderr
    for wrong in (
        ["--fixed", "f0"],
        ["--bound", "f0=1"],
        ["--fixed", "f0=x"],
        ["--bound", "a=1,2,3"],
    ):
        result = cli("fit", "paint.binary", "-m", "ggx", *wrong)
        assert (result.exit_code, result.stderr.count("\n")) == (2, 1)
        name = wrong[1].partition("=")[0]
        assert f"{wrong[0]} {wrong[1]!r} should read {name}=" in result.stderr


def test_values_that_gain_light_are_told(cli):
    words = "render", "lambert", *SMALL, "-p"
    assert "reflects" not in cli(*words, "diffuse_reflectance=0.5", "-o", "a.png").stderr
    said = "lambert reflects 5.00 of the light, more than arrives."
    assert said in cli(*words, "diffuse_reflectance=5,5,5", "-o", "b.png").stderr
