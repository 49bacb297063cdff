"""Environment maps: those that come with brdfkit, their audit, and conversions of conventions."""

import importlib
import importlib.util
import json
from pathlib import Path

import mitsuba as mi
import numpy as np
import pytest

import brdfkit as bk
from brdfkit.cli import main
from brdfkit.core import catalogue
from brdfkit.core.colours import luminance
from brdfkit.lighting.environments.conventions import LAYOUTS, NAMED, parse_convention
from brdfkit.lighting.environments.light_distribution import pixel_solid_angles
from brdfkit.lighting.environments.map_files import read_map, write_map
from brdfkit.lighting.environments.resampling import look_up_map, resample

MAPS = sorted(catalogue.list_environments())
RANDOM = np.random.default_rng(5).normal(size=(400, 3))
DIRECTIONS = RANDOM / np.linalg.norm(RANDOM, axis=1, keepdims=True)


@pytest.fixture(scope="module")
def maps():
    return {name: read_map(catalogue.find_environment_file(name)) for name in MAPS}


@pytest.fixture(scope="module")
def make():
    """The program that makes the maps, as a module."""
    file = catalogue.find_data_folder(catalogue.ENVIRONMENTS) / "make.py"
    spec = importlib.util.spec_from_file_location("make_environments", file)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def smooth(d):
    """Radiance that varies slowly with the direction (..., 3), differently in every channel."""
    return np.stack([2 + d[..., 0], 2 + d[..., 1] + d[..., 2] / 2, 2 + d[..., 2] ** 2], axis=-1)


def map_of(radiance, name, height):
    """The map of a function of directions in a world with y up, in a convention."""
    found = parse_convention(name)
    width = round(height * found.layout.aspect)
    x, y = np.arange(width)[None, :], np.arange(height)[:, None]
    towards = found.layout.directions(x, y, height, width) @ found.frame.T
    return np.where(np.isfinite(towards[..., :1]), radiance(np.nan_to_num(towards)), 0)


# The shipped maps


@pytest.mark.parametrize("name", MAPS)
def test_shipped(maps, name):
    """Small, clean, and bright enough; no pixel is a firefly, far above all around it."""
    entry, file = catalogue.list_environments()[name], catalogue.find_environment_file(name)
    assert file.stat().st_size <= 200_000
    assert (entry.name, entry.file, entry.licence) == (name, f"{name}.exr", "BSD-3-Clause")
    rgb = maps[name]
    assert rgb.shape == (128, 256, 3)
    assert np.isfinite(rgb).all()
    assert rgb.min() >= 0
    if name == "sky":  # the sun is two pixels, far above all around them
        return
    around = [np.roll(luminance(rgb), (i, j), (0, 1)) for i in (-1, 0, 1) for j in (-1, 0, 1)]
    lone = around[4] > 4 * np.max([a for k, a in enumerate(around) if k != 4], axis=0) + 0.1
    assert not lone.any()


def test_the_folder_holds_what_the_index_names():
    files = {file.name for file in catalogue.find_data_folder(catalogue.ENVIRONMENTS).glob("*.exr")}
    assert files == {entry.file for entry in catalogue.list_environments().values()}


def test_the_program_makes_what_is_shipped(maps, make, module_in_llvm):
    """The drawn map equally; of the others, coarse ones have the same light in every octant."""
    assert np.allclose(make.compass(), maps["compass"], atol=1e-3)
    coarse = {
        "sky": make.sky(32),
        "studio": make.studio(32, (1, 64)),
        "room": make.room(32, (1, 64)),
    }
    for name, rgb in coarse.items():
        assert np.allclose(_octants(rgb), _octants(maps[name]), rtol=0.06), name


def _octants(rgb):
    """The light from each octant of directions, in linear R, G, B."""
    height, width = rgb.shape[:2]
    light = rgb * pixel_solid_angles(height, width)[..., None]
    return light.reshape(2, height // 2, 4, width // 4, 3).sum(axis=(1, 3))


# Conventions


@pytest.mark.quick
@pytest.mark.parametrize("name", LAYOUTS)
def test_places_are_where_their_directions_are(name):
    layout, height = LAYOUTS[name], 240
    width = round(height * layout.aspect)
    x, y, part = layout.pixel_coordinates(DIRECTIONS, height, width)
    back = layout.directions(x, y, height, width)
    # on the rims of discs, places are moved to the nearest pixel of the disc
    near = 1.5 * np.pi / height if name in ("angular", "paraboloids") else 1e-9
    assert np.linalg.norm(back - DIRECTIONS, axis=1).max() < near
    assert x.min() > -0.51
    assert x.max() < width - 0.49
    assert set(part) == set(range(part.max() + 1))


def _blender(d):
    x, y, z = d.T  # Cycles, direction_to_equirectangular; v from below
    return 0.5 - np.arctan2(y, x) / (2 * np.pi), np.arccos(z) / np.pi


def _pbrt(d):
    x, y, z = d.T  # InfiniteAreaLight::Le
    return np.arctan2(y, x) % (2 * np.pi) / (2 * np.pi), np.arccos(z) / np.pi


def _three(d):
    x, y, z = d.T  # equirectUv; v from below
    return np.arctan2(z, x) / (2 * np.pi) + 0.5, 0.5 - np.arcsin(y) / np.pi


def _usc(d):
    x, y, z = d.T  # the page's: D = (sin(phi) sin(theta), cos(phi), -sin(phi) cos(theta))
    return np.arctan2(x, -z) / (2 * np.pi) + 0.5, np.arccos(y) / np.pi


@pytest.mark.quick
@pytest.mark.parametrize(
    ("name", "formula", "z_up"),
    [
        ("blender", _blender, True),
        ("pbrt-v3", _pbrt, True),
        ("three.js", _three, False),
        ("usc", _usc, False),
    ],
)
def test_programs_look_up_where_their_code_does(name, formula, z_up):
    """z up to y up: (x, y, z) → (x, z, -y)."""
    found = parse_convention(name)
    d = DIRECTIONS
    world = np.stack([d[:, 0], d[:, 2], -d[:, 1]], axis=1) if z_up else d
    x, y, _ = found.layout.pixel_coordinates(world @ found.frame, 100, 200)
    u, v = formula(d)
    apart = (x + 0.5) / 200 - u
    assert np.abs(apart - np.round(apart)).max() < 1e-9
    assert np.allclose((y + 0.5) / 100, v)


@pytest.mark.quick
def test_debevec_looks_up_as_the_page_says():
    """(u, v) = (Dx r, Dy r), r = acos(-Dz) / (π √(Dx² + Dy²)), as (0, 0, -1) is in the middle.

    The page has acos(Dz) in this formula, against its own text, which turns (0, 0, -1) by phi.
    """
    found, (x, y, z) = parse_convention("debevec"), DIRECTIONS.T
    r = np.arccos(-z) / np.pi / np.hypot(x, y)
    px, py, _ = found.layout.pixel_coordinates(DIRECTIONS @ found.frame, 500, 500)
    assert np.allclose((px + 0.5) / 250 - 1, x * r, atol=0.005)
    assert np.allclose(1 - (py + 0.5) / 250, y * r, atol=0.005)


@pytest.mark.quick
def test_faces_are_those_of_opengl():
    """OpenGL 4.6, table 8.19: (sc, tc) of the faces +x -x +y -y +z -z, s = (sc / |ma| + 1) / 2."""
    found, (x, y, z) = parse_convention("opengl"), DIRECTIONS.T
    sc = np.array([-z, z, x, x, x, -x])
    tc = np.array([-y, -y, z, -z, -y, -y])
    ma = np.array([x, -x, y, -y, z, -z])
    face, every = ma.argmax(axis=0), np.arange(len(x))
    px, py, part = found.layout.pixel_coordinates(DIRECTIONS @ found.frame, 64, 384)
    assert (part == face).all()
    s, t = ((c[face, every] / ma[face, every] + 1) / 2 for c in (sc, tc))
    assert np.allclose((px + 0.5) / 64 - face, s)
    assert np.allclose((py + 0.5) / 64, t)


def test_mitsuba_looks_up_as_mitsuba_does(module_in_llvm):
    rgb = np.random.default_rng(1).random((9, 16, 3)).astype(np.float32)
    emitter = mi.load_dict({"type": "envmap", "bitmap": mi.Bitmap(rgb)})
    si = mi.SurfaceInteraction3f()
    si.wi = -mi.Vector3f(DIRECTIONS.T.astype(np.float32))
    theirs = np.array(emitter.eval(si)).T
    found = parse_convention("mitsuba")
    assert np.allclose(look_up_map(rgb, found.layout, DIRECTIONS @ found.frame), theirs, atol=2e-4)


@pytest.mark.parametrize("source", [*NAMED, "cross", "vertical_cross", "paraboloids"])
def test_conversions_keep_the_light_of_every_direction(source):
    """Of a smooth map: to Mitsuba's convention, and back from there."""
    before, mitsuba = map_of(smooth, source, 96), map_of(smooth, "mitsuba", 96)
    to = resample(before, parse_convention(source), parse_convention("mitsuba"), 96)
    assert np.abs(to - mitsuba).max() < 0.04
    back = resample(mitsuba, parse_convention("mitsuba"), parse_convention(source), 96)
    seen = before.any(axis=2)
    assert np.abs(back - before)[seen].max() < 0.04


@pytest.mark.quick
def test_mirrors_and_quarter_turns_lose_nothing():
    rgb = np.random.default_rng(2).random((8, 16, 3))
    mitsuba = parse_convention("mitsuba")
    mirrored = resample(rgb, mitsuba, mitsuba, 8, mirror=True)
    assert np.allclose(mirrored, rgb[:, ::-1])
    # 90° anticlockwise takes +z, in the middle, to +x, a quarter to the left
    turned = resample(rgb, mitsuba, mitsuba, 8, turn=90)
    assert np.allclose(turned, np.roll(rgb, -4, axis=1))
    half = resample(rgb, mitsuba, mitsuba, 8, turn=180 / 16)
    assert np.allclose(half, (rgb + np.roll(rgb, -1, axis=1)) / 2)
    assert np.allclose(resample(rgb, mitsuba, mitsuba, 8), rgb)


def test_the_power_stays(maps):
    """Of a map with small bright lamps, converted to fewer pixels and back."""
    rgb, mitsuba, cross = maps["room"], parse_convention("mitsuba"), parse_convention("cross")
    back = resample(resample(rgb, mitsuba, cross, 96), cross, mitsuba, 64)
    light = [
        (m * pixel_solid_angles(*m.shape[:2])[..., None]).sum(axis=(0, 1)) for m in (rgb, back)
    ]
    assert np.allclose(*light, rtol=0.02)


@pytest.mark.quick
def test_compass(maps, make):
    """Every side has its colour; a minus is left of its letter; the seam has its two columns."""
    rgb = maps["compass"]
    sides = {"+x": (40, 64), "-x": (168, 64), "+z": (104, 64), "-z": (232, 64)}
    found = {side: rgb[row, column] for side, (column, row) in sides.items()}
    found |= {"+y": rgb[22, 128], "-y": rgb[104, 128]}
    for side, colour in make.COLOURS.items():
        assert np.allclose(found[side], colour, atol=0.01), side
    white = (rgb[64] > 2).all(axis=1)
    assert white[160:192].sum() > white[192:224].sum()  # on the face -x, whose middle is 192
    assert (rgb[:, 0] == 3).all()
    assert (rgb[:, -1] == 0).all()


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        ({"source": "blendr"}, "no convention of maps 'blendr'; did you mean blender?"),
        ({"target": "latlong:+x+x+z"}, "should be the axes to the right, up and ahead"),
        ({"target": "latlong:+y+x+z"}, "each once, and y or z up"),
        ({"source": "cross"}, "sky: the map has 256×128 pixels, but its layout 1.33 times"),
        ({"target": "cross", "height": 100}, "height = 100 should be a multiple of 3"),
        ({"turn": np.nan}, "turn = nan should be a number"),
        ({"path": "sky.png"}, r"sky\.png: maps are written as \.exr"),
    ],
)
def test_what_cannot_be_converted(tmp_path, monkeypatch, words, sentence):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(bk.BrdfkitError, match=sentence):
        bk.environments.convert("sky", **{"path": "new.exr", **words})
    assert not list(tmp_path.iterdir())


# The audit


@pytest.mark.quick
def test_an_audit_of_a_known_map():
    """Radiance 1, and 100 within 20° about a direction: 3.015 % of the solid angle."""
    towards = np.array([0.6, 0.48, 0.64])

    def radiance(d):
        bright = np.where(d @ towards > np.cos(np.radians(20)), 100.0, 1.0)
        return np.repeat(bright[..., None], 3, axis=-1)

    found = bk.environments.audit(map_of(radiance, "mitsuba", 256))
    share = (1 - np.cos(np.radians(20))) / 2
    assert found.mean == pytest.approx(1 + 99 * share, rel=0.005)
    assert (found.median, found.largest) == (1, pytest.approx(100))
    assert found.brightest_share == pytest.approx(0.01 * 100 / found.mean, rel=0.01)
    assert np.dot(found.brightest, towards) > np.cos(np.radians(21))
    assert (found.not_finite, found.negative, found.eight_bit) == (0, 0, False)
    up = 0.5 + 99 * share  # the spot is above the horizon
    assert found.above == pytest.approx(up / found.mean, rel=0.01)


def one_pixel(value):
    rgb = np.random.default_rng(0).random((16, 32, 3)).astype(np.float32)
    rgb[3, 5] = value
    return rgb


UPSIDE_DOWN = np.linspace(0, 1, 16)[:, None, None] ** 2 * one_pixel(0.5)
CLIPPED = np.minimum(one_pixel(0.5), 0.4)


@pytest.mark.quick
@pytest.mark.parametrize(
    ("rgb", "finding"),
    [
        (one_pixel(np.nan), "1 pixels are not finite"),
        (one_pixel(np.inf), "1 pixels are not finite"),
        (one_pixel(-1), "1 pixels are negative"),
        (np.zeros((4, 8, 3)), "the map is black"),
        (np.ones((4, 8, 3)), "all pixels are equal"),
        (one_pixel(0.5)[:, :16], "16 × 16 pixels are not twice as wide as high"),
        (CLIPPED, "pixels share the largest luminance, 0.4: clipped"),
        (UPSIDE_DOWN, "of the light comes from below: perhaps upside down"),
    ],
)
def test_findings(rgb, finding):
    found = bk.environments.audit(rgb)
    assert any(finding in sentence for sentence in found.findings()), found.findings()
    assert finding in str(found)
    assert found.picture().axes


def test_shipped_maps_are_not_doubtful():
    for name in {*MAPS} - {"compass"}:
        clipped = "unless a computer made the map"  # one did
        assert all(clipped in f for f in bk.environments.audit(name).findings()), name


# Bad files


# Sizes that the headers of damaged Radiance files state
SIZES = {
    "huge.hdr": "-Y 99999999 +X 99999999",
    "negative.hdr": "-Y -5 +X 10",
    "overflow.hdr": "-Y 4294967299 +X 18446744073709551617",
}

WIDTH = one_pixel(0.5).shape[1]
PACKED = bytes((2, 2, WIDTH >> 8, WIDTH & 255))  # how a row begins; Mitsuba crashed without


@pytest.fixture
def bad(tmp_path, monkeypatch):
    """A folder with files that are no good maps."""
    monkeypatch.chdir(tmp_path)
    good = one_pixel(0.5)
    whole = write_map(good, "whole.exr").read_bytes()
    (tmp_path / "cut.exr").write_bytes(whole[: len(whole) // 2])
    mi.Bitmap(good).write("whole.hdr")
    whole = (tmp_path / "whole.hdr").read_bytes()
    (tmp_path / "cut.hdr").write_bytes(whole[: len(whole) // 2])
    begins = whole.index(PACKED) + 4  # the first row's colours
    unpacked = whole[begins : whole.index(PACKED, begins)] + bytes(1000)
    (tmp_path / "half_packed.hdr").write_bytes(whole[:begins] + unpacked)
    (tmp_path / "wide_run.hdr").write_bytes(whole[:begins] + b"\xff\0" + whole[begins + 2 :])
    (tmp_path / "words.hdr").write_bytes(whole.replace(b"+X", b"+X x"))
    for name, size in SIZES.items():
        head = f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n{size}\n"
        (tmp_path / name).write_bytes(head.encode() + whole[-20:])
    (tmp_path / "text.exr").write_text("no picture")
    (tmp_path / "empty.exr").write_bytes(b"")
    write_map(good[:1, :1], "one.exr")
    write_map(one_pixel(np.nan), "nan.exr")
    write_map(one_pixel(-1), "negative.exr")
    write_map(one_pixel(np.inf), "infinite.exr")
    write_map(good[:, :16], "square.exr")
    write_map(0 * good, "black.exr")
    return tmp_path


@pytest.mark.parametrize("file", ["half_packed.hdr", "wide_run.hdr"])
def test_a_damaged_map_of_a_scene_file_ends_no_process(file, bad, module_in_llvm):
    """Mitsuba leaves its memory as it reads one."""
    scene = f"""<scene version="3.0.0"><integrator type="path"/><sensor type="perspective"/>
        <emitter type="envmap"><string name="filename" value="{file}"/></emitter></scene>"""
    Path("lit.xml").write_text(scene)
    with pytest.raises(bk.BrdfkitError, match=rf"^lit.xml: {file}: its row \d is damaged"):
        bk.render("lit.xml", spp=1)


def test_bad_files(bad, module_in_llvm):
    """One sentence each, by whichever verb reads them; nothing is written."""
    everywhere = {
        "cut.exr": "fetch it again",
        "cut.hdr": "fetch it again",
        **dict.fromkeys(SIZES, "states a size for which there is no memory"),
        "half_packed.hdr": "its row 2 is damaged",
        "wide_run.hdr": "its row 1 is damaged",
        "words.hdr": "it is damaged: save or fetch it again",
        "text.exr": "fetch it again",
        "empty.exr": "fetch it again",
        "one.exr": "1×1 pixels; it needs 2×2",
        "none.exr": "there is no such file",
        "studoi": "no file or environment map 'studoi'; did you mean studio?",
    }
    lights = {
        "nan.exr": "a value that is negative or not finite",
        "negative.exr": "a value that is negative or not finite",
        "infinite.exr": "a value that is negative or not finite",
        "square.exr": "2 times as many columns as rows",
    }
    renders = {"black.exr": "gives no light from above"}
    before = set(bad.iterdir())
    verbs = {
        bk.environments.audit: everywhere,
        lambda file: bk.environments.convert(file, "new.exr"): everywhere | lights,
        lambda file: bk.render("lambert", spp=1, size=8, environment=file): everywhere
        | lights
        | renders,
    }
    for verb, sentences in verbs.items():
        for file, sentence in sentences.items():
            with pytest.raises(bk.BrdfkitError) as told:
                verb(file)
            assert file in str(told.value)
            assert sentence in str(told.value)
            assert "\n" not in str(told.value)
    assert set(bad.iterdir()) == before


def test_eight_bit_pictures_are_said_to_be(tmp_path):
    file = tmp_path / "sky.png"
    mi.Bitmap((255 * one_pixel(0.5)).astype(np.uint8)).write(str(file))
    assert "8 bits per channel" in str(bk.environments.audit(file))
    with pytest.warns(UserWarning, match="8 bits per channel"):
        bk.environments.convert(file, tmp_path / "sky.exr", target="cross")


# By name, and on the command line


def test_a_name_lights_a_picture(module_in_llvm):
    by_name = bk.render("lambert", spp=4, size=16, environment="sky").pictures["lambert"]
    file = catalogue.find_environment_file("sky")
    assert np.allclose(
        by_name, bk.render("lambert", spp=4, size=16, environment=file).pictures["lambert"], 1e-4
    )


def run(capsys, *words):
    with pytest.raises(SystemExit) as ended:
        main(words)
    said = capsys.readouterr()
    return ended.value.code, said.out, said.err


def test_commands(make, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    code, out, _ = run(capsys, "info", "sky", "-o", "sky.png", "--json")
    found = json.loads(out)
    assert (code, found["width"], found["written"]) == (0, 256, ["sky.png"])
    assert found["brightest_share"] > 0.5
    assert "brightest 1 %" in run(capsys, "info", "studio")[1]
    words = "convert", "compass", "cross.exr", "--target", "cross", "--turn", "90", "--height", "96"
    assert run(capsys, *words)[:2] == (0, "written: cross.exr\n")
    assert read_map("cross.exr").shape == (96, 128, 3)
    assert np.allclose(read_map("cross.exr")[48, 34], make.COLOURS["-x"], atol=0.01)
    code, _, told = run(capsys, "convert", "car_paint", "new.npz", "--mirror")
    assert code == 2
    assert "car_paint is no environment map" in told
    code, _, told = run(capsys, "convert", "sky", "new.exr", "--set", "kd=1")
    assert code == 2
    assert "--set works for models only" in told
    assert {f.name for f in tmp_path.iterdir()} == {"sky.png", "cross.exr"}


def test_public_maps(capsys):
    """Their pages are named; their conventions are ones that `convert` knows, or in words."""
    _, out, _ = run(capsys, "data", "--json")
    named = json.loads(out)["environment maps"]
    assert {"polyhaven", "debevec", "usc"} <= set(named)
    assert "Convention: usc" in run(capsys, "data", "list", "usc")[1]
    for name, found in catalogue.list_map_collections().items():
        assert found.page.startswith("http")
        assert found.page in named[name]["page"]
        if " " not in found.convention:
            parse_convention(found.convention)


def test_the_how_to_names_all_conventions():
    page = (Path(__file__).parents[2] / "docs/how_to/mirrored_environment.md").read_text("utf-8")
    for name, short_for in NAMED.items():
        assert f"| `{name}` | `{short_for}` |" in page
    for name in LAYOUTS:
        assert f"`{name}`" in page


def test_the_page_of_the_maps_is_what_they_are():
    """Otherwise: python docs/tools/make_environments.py"""
    make = importlib.import_module("make_environments")
    assert make.PAGE.read_text(encoding="utf-8") == make.make_page()
