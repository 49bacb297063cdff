"""`svbrdf`: maps from photographs that Mitsuba rendered of maps that are known."""

import dataclasses
import json

import made_capture
import numpy as np
import pytest
from click.testing import CliRunner
from scipy.ndimage import minimum_filter

import brdfkit as bk
from brdfkit.cli import main
from brdfkit.core.jit.threads import use_two_threads
from brdfkit.inverse.photographs.arguments import to_texel_parameters
from brdfkit.inverse.photographs.capture.camera_from_corners import find_camera
from brdfkit.inverse.photographs.capture.capture import downsample
from brdfkit.inverse.photographs.capture.observations import Observations
from brdfkit.inverse.photographs.capture.pinhole import find_corners
from brdfkit.inverse.photographs.maps.maps import Maps, to_texel_numbers
from brdfkit.inverse.photographs.maps.scene import format_scene_xml, make_bsdf_dict
from brdfkit.inverse.photographs.maps.shape_parameters import ANGLE
from brdfkit.inverse.photographs.search import coarse_to_fine
from brdfkit.inverse.photographs.search.problem import Problem
from brdfkit.mitsuba_bridge.scene_file import load_scene_file

TEXELS, LIGHTS = 32, 16


@pytest.fixture(scope="module")
def made(mi):
    return made_capture.photographs(TEXELS, LIGHTS)


@pytest.fixture(scope="module")
def found(made):
    return bk.photographs.svbrdf(made[1], resolution=TEXELS)


def inner(values):
    """Without the edge, where pixels see the dark beside the sample."""
    return values[3:-3, 3:-3]


def test_the_formula_is_what_mitsuba_shows(mi):
    """At the truth, seen in so many pixels that they blur little."""
    truth, capture = made_capture.photographs(TEXELS, 3, noise=0, pixels=8 * TEXELS)
    seen = Observations.collect(capture, (TEXELS, TEXELS))
    numbers, x = to_texel_numbers(Maps(truth.model, truth.fixed, truth.size, truth.maps))
    off = numbers.compute_radiances(x, seen) - seen.radiance
    off = (off * np.sqrt(seen.weights)).reshape(3, TEXELS, TEXELS, 3)[:, 1:-1, 1:-1]
    assert np.sqrt((off**2).mean()) < 0.005


def test_the_maps_come_back(made, found):
    truth, _ = made
    for name, most in (
        ("diffuse_reflectance", 0.004),
        ("specular_reflectance", 0.01),
        ("alpha_u", 0.005),
        ("normal", 0.003),
    ):
        off = inner(found.maps[name]) - inner(truth.maps[name])
        assert np.sqrt((off**2).mean()) < most, name


@pytest.mark.parametrize("noise", [0.003, 0.01])
def test_standard_errors_hold(mi, noise):
    """1.96 of them contain 95 %: pixels' blur, lost details and noise all have a part."""
    truth, capture = made_capture.photographs(48, 12, noise)
    found = bk.photographs.svbrdf(capture, resolution=48, smoothness=0.03)
    for name, errors in found.uncertainty.items():
        off = inner(found.maps[name] - truth.maps[name])
        off = np.linalg.norm(off, axis=-1) if name == "normal" else np.atleast_3d(off)
        within = np.abs(off) < 1.96 * inner(errors).reshape(off.shape[:2] + (1,) * (off.ndim - 2))
        assert 0.93 < within.mean() < 0.97, name


def test_lights_that_were_held_out_are_predicted(mi, made, found):
    """40 dB and more, by Mitsuba's picture of the maps beside that of the truth."""
    truth, _ = made
    positions, intensities = made_capture.lights(3, seed=9)
    for light in zip(positions, intensities, strict=True):
        a, b = (
            made_capture.photograph(make_bsdf_dict(one), *light, round(1.4 * TEXELS))
            for one in (found, truth)
        )
        inside = b.max(axis=2) > 0
        error = ((a - b)[inside] ** 2).mean()
        assert 10 * np.log10(np.quantile(b[inside], 0.99) ** 2 / error) > 40


def test_relighting_is_what_mitsuba_shows(mi, found):
    """Of a sample seen from above, whose texels are pixels."""
    (position,), (intensity,) = made_capture.lights(1, seed=11)
    picture = found.relight(position, intensity=intensity, viewer=(0, 0, 1e3))
    t = mi.ScalarTransform4f()
    sensor = {
        "type": "orthographic",
        "to_world": t.look_at([0, 0, 1], [0, 0, 0], [0, 1, 0]) @ t.scale(made_capture.SIDE / 2),
        "film": {
            "type": "hdrfilm",
            "width": TEXELS,
            "height": TEXELS,
            "pixel_format": "rgb",
            "rfilter": {"type": "box"},
        },
    }
    light = {
        "type": "point",
        "position": position,
        "intensity": {"type": "rgb", "value": intensity},
    }
    scene = {"type": "scene", "sensor": sensor, "sample": found.scene_dict(), "light": light}
    expected = np.array(mi.render(mi.load_dict(scene | {"integrator": {"type": "direct"}}), spp=64))
    off = inner(picture) / inner(expected) - 1
    assert np.sqrt((off**2).mean()) < 0.02


@pytest.mark.parametrize("anisotropic", [False, True])
@pytest.mark.parametrize("model", ["ggx", "ward", "ashikhmin_shirley"])
def test_derivatives_are_those_of_differences(made, model, anisotropic):
    numbers, rng = to_texel_parameters(model, anisotropic, {}), np.random.default_rng(0)
    assert len(numbers.shapes.number_names) == len(numbers.names) + anisotropic
    seen = Observations.collect(made[1], (TEXELS, TEXELS)).select_texels(np.arange(100, 108))
    low, high = (np.clip(limit, -0.3, 1) for limit in numbers.find_limits())
    x = low + (0.3 + 0.4 * rng.random((8, numbers.count))) * (high - low)
    problem = Problem(numbers, seen)
    about = problem.compute_equations(x)
    for j in range(numbers.count):
        step = 1e-5 * np.eye(numbers.count)[j]
        ends = [problem.compute_errors(x + sign * step) for sign in (1, -1)]
        slope = (ends[0] - ends[1]) / 4e-5  # half of E²'s
        np.testing.assert_allclose(about.gradient[:, j], slope, rtol=1e-4, atol=1e-6)


def test_what_is_found_says_what_it_is(found):
    assert "ggx" in str(found)
    assert min(found.predicted.values()) > 35
    assert found.smoothness in found.held_out
    for name, values in found.maps.items():
        assert values.shape[:2] == found.shape == found.uncertainty[name].shape
        assert np.isfinite(found.uncertainty[name]).all()


def test_widths_of_two_directions_come_back_as_one(made):
    """The sample is isotropic, which two maps of width should find out."""
    truth, capture = made
    found = bk.photographs.svbrdf(capture, resolution=TEXELS, anisotropic=True, smoothness=0.1)
    for name in ("alpha_u", "alpha_v"):
        assert np.median(np.abs(inner(found.maps[name] / truth.maps["alpha_u"] - 1))) < 0.05


def test_the_direction_of_a_brushed_metal_comes_back(mi, tmp_path):
    """As one that is turned on a lathe: all directions, with a seam."""
    truth = made_capture.Truth(TEXELS)
    row, column = np.mgrid[:TEXELS, :TEXELS] / TEXELS
    truth.maps |= {
        "alpha_u": 0.4 + 0.1 * row,
        "alpha_v": 0.15 + 0.05 * column,
        ANGLE: np.arctan2(0.2 - row, column - 0.6) % np.pi - np.pi / 2,
    }
    _, capture = made_capture.photographs(TEXELS, LIGHTS, truth=truth)
    found = bk.photographs.svbrdf(capture, anisotropic=True, resolution=TEXELS)
    for name in ("alpha_u", "alpha_v"):
        assert np.median(np.abs(inner(found.maps[name] / truth.maps[name] - 1))) < 0.03
    off = inner(found.maps[ANGLE] - truth.maps[ANGLE] + np.pi / 2) % np.pi - np.pi / 2
    assert np.median(np.abs(off)) < np.radians(1)
    assert (np.abs(off) < 2 * inner(found.uncertainty[ANGLE])).mean() > 0.85
    found.write(tmp_path)
    scene = load_scene_file(tmp_path / "sample.xml")
    shown = np.array(mi.render(scene, spp=16))[..., :3]
    counted = found.capture.counted[0]
    assert np.abs(shown[counted] / found.rendered[0][counted] - 1).mean() < 0.005


def test_models_with_options_and_sums_can_be_shown(mi, made):
    found = bk.photographs.svbrdf(made[1], "ggx+ward", resolution=8, smoothness=0.1)
    assert mi.load_dict(found.scene_dict()).bsdf() is not None
    assert 'name="models" value="ggx+ward"' in format_scene_xml(found, {n: n for n in found.maps})


def test_ctrl_c_keeps_the_coarser_maps(made, monkeypatch, tmp_path):
    """Nothing is rendered any more, and no standard errors are found: that took 22 s."""
    original, calls = coarse_to_fine.fit_with_restarts, []

    def stop(*args):
        calls.append(args)
        if len(calls) > 2:
            raise KeyboardInterrupt
        return original(*args)

    monkeypatch.setattr(coarse_to_fine, "fit_with_restarts", stop)
    with pytest.raises(bk.Interrupted) as stopped:
        bk.photographs.svbrdf(made[1], resolution=TEXELS, smoothness=0.1)
    best = stopped.value.best
    assert best.shape == (TEXELS, TEXELS)
    off = best.maps["diffuse_reflectance"] - made[0].maps["diffuse_reflectance"]
    assert np.sqrt((off**2).mean()) < 0.1
    assert "Interrupted" in best.notes[0]
    assert best.rendered is None
    assert best.uncertainty == {}
    assert "PSNR" not in str(best)
    (tmp_path / "alpha_u_error.exr").touch()  # of other maps
    best.write(tmp_path)
    written = {path.name for path in tmp_path.iterdir()}
    assert written == {*(f"{name}.exr" for name in best.maps), "sample.xml", "report.html"}
    assert np.ptp(best.maps["alpha_u"][:2, :2]) == 0  # texels twice as large


def test_one_light_says_what_trades_off(made):
    capture = made[1]
    first = (capture.pictures[:1], capture.positions[:1], capture.intensities[:1])
    alone = dataclasses.replace(
        capture, pictures=first[0], positions=first[1], intensities=first[2], names=("one.exr",)
    )
    found = bk.photographs.svbrdf(alone, resolution=8)
    assert "One light: roughness and strength trade off" in found.notes[0]
    assert np.median(found.uncertainty["normal"]) < 1  # about its range


def test_clipped_numbers_are_found_in_each_colour(made):
    """A white balance moves the ends of the colours apart."""
    capture = made[1]
    ends = np.quantile(capture.pictures, 0.99, axis=(0, 1, 2))
    clipped = dataclasses.replace(capture, pictures=np.minimum(capture.pictures, ends)).clipped
    assert (clipped == (capture.pictures >= ends)).all()
    assert not capture.clipped.any()


def test_matt_parts_of_a_sample_of_metal_come_back(mi):
    """Where most texels have no diffuse term, that of the others should not be smoothed away."""
    truth = made_capture.Truth(24)
    metal = np.arange(24) % 12 < 8
    truth.maps["diffuse_reflectance"][:, metal] = 0
    truth.maps["specular_reflectance"][:, ~metal] *= 0.1
    _, capture = made_capture.photographs(24, LIGHTS, truth=truth)
    found = bk.photographs.svbrdf(capture, resolution=24)
    off = inner(found.maps["diffuse_reflectance"] - truth.maps["diffuse_reflectance"])
    assert np.sqrt((off**2).mean()) < 0.08  # 0.18 with units by the weights' own median


def test_parts_that_fit_badly_begin_again(mi):
    """Materials with sharp edges, few highlights each: a third of the metal was 34° off."""
    truth = made_capture.Truth(48)
    row, column = np.mgrid[:48, :48]
    metal = np.hypot(row - 20, column - 30) < 10
    white = ((row // 12 + column // 12) % 2 == 0) & ~metal
    for name, values in {
        "diffuse_reflectance": ([0.25, 0.12, 0.06], [0.6, 0.6, 0.62], [0.02, 0.015, 0.01]),
        "specular_reflectance": ([0.12] * 3, [0.25] * 3, [0.9, 0.7, 0.35]),
        "alpha_u": (0.4, 0.2, 0.25),
    }.items():
        truth.maps[name] = np.array(values)[1 * white + 2 * metal]
    truth.maps["normal"][:] = 0, 0, 1
    _, capture = made_capture.photographs(48, 10, truth=truth)
    found = bk.photographs.svbrdf(capture, resolution=48)
    flat = minimum_filter(metal, 3)
    off = (found.maps["specular_reflectance"] - truth.maps["specular_reflectance"])[flat]
    assert (np.abs(off).max(axis=1) > 0.2).mean() < 0.01
    assert np.degrees(np.arccos(found.maps["normal"][flat][:, 2])).max() < 5


@pytest.mark.parametrize(
    ("fields", "sentence"),
    [
        ({"positions": [[1, -1, 1]]}, "more than noise: check the camera"),
        ({"intensities": [[100, 100, 100]]}, "check the unit of the intensities"),
    ],
)
def test_what_cannot_be_is_said(made, fields, sentence):
    """Lights whose y is upside down, intensities of another unit."""
    changed = {name: getattr(made[1], name) * factor for name, factor in fields.items()}
    found = bk.photographs.svbrdf(
        dataclasses.replace(made[1], **changed), resolution=16, smoothness=0.1
    )
    assert sentence in str(found).replace("\n", " ").replace("  ", " ")


def test_one_light_in_a_wrong_place_is_named(made):
    positions = made[1].positions.copy()
    positions[3, 0] *= -1
    found = bk.photographs.svbrdf(dataclasses.replace(made[1], positions=positions), resolution=16)
    assert any("Worst explained: 03.exr;" in note for note in found.notes)


def test_photographs_of_many_pixels_are_made_smaller(made):
    """By blocks of an odd side: what is seen where stays, and what is clipped counts no more."""
    _, capture = made_capture.photographs(TEXELS, 2, noise=0, pixels=8 * TEXELS + 3)
    pictures = capture.pictures.copy()
    pictures[0, 100:103, 100] = pictures.max()
    lost = pictures == pictures.max()
    small = downsample(dataclasses.replace(capture, pictures=pictures, lost=lost), (TEXELS, TEXELS))
    assert 1.4 * TEXELS < small.picture_size[0] < 3 * TEXELS
    assert small.excluded[0].any()
    places = np.array([[0.03, -0.02, 0], [-0.04, 0.01, 0]])
    shares = [
        c.camera.project(places, c.picture_size) / c.picture_size[0] for c in (capture, small)
    ]
    side = round(capture.pixel_size(capture.camera)[0] ** -1 * small.pixel_size(small.camera)[0])
    scale = small.picture_size[0] * side / capture.picture_size[0]
    np.testing.assert_allclose(0.5 + (shares[0] - 0.5) / scale, shares[1], atol=1e-12)
    mean = capture.pictures[1][capture.counted[1]].mean()
    np.testing.assert_allclose(small.pictures[1][small.counted[1]].mean(), mean, rtol=0.03)


def test_the_command_writes_maps_a_scene_and_a_report(mi, made, tmp_path):
    made_capture.write_capture(made[1], tmp_path)
    arguments = ["svbrdf", str(tmp_path), "--resolution", "12", "--smoothness", "0.1", "--json"]
    result = CliRunner().invoke(main, arguments)
    assert result.exit_code == 0, result.output
    said = json.loads(result.stdout)
    names = {path.rsplit("/", 1)[-1] for path in said["written"]}
    assert {"normal.exr", "alpha_u_error.exr", "misfit.exr", "sample.xml", "report.html"} <= names
    scene = load_scene_file(tmp_path / "maps" / "sample.xml")
    shown = np.array(mi.render(scene, spp=16))[..., :3]
    photograph = made[1].pictures[0]
    inside = photograph.min(axis=2) > 0.2 * photograph.mean()
    off = shown[inside].mean(axis=0) / photograph[inside].mean(axis=0)
    np.testing.assert_allclose(off, 1, atol=0.03)
    upright = np.corrcoef(shown[inside].ravel(), photograph[inside].ravel())[0, 1]
    assert upright > 0.97  # 0.55 upside down
    assert "<img" in (tmp_path / "maps" / "report.html").read_text(encoding="utf-8")


def change(capture, **fields):
    return lambda: bk.photographs.svbrdf(dataclasses.replace(capture, **fields))


def test_bad_captures_are_one_sentence(made):
    c = made[1]
    below, dark = c.positions.copy(), c.intensities.copy()
    below[2, 2], dark[1] = -0.1, 0
    cases = {
        "light is at z = -0.1 m, behind": {"positions": below},
        "each light needs one above 0": {"intensities": dark},
        "not finite": {"pictures": np.where(c.pictures > c.pictures.mean(), np.nan, c.pictures)},
        "should be \\(lights, height, width, 3\\)": {"pictures": c.pictures[..., 0]},
        "should be \\(16, 3\\)": {"positions": c.positions[:5]},
        "does not see all four corners": {"size": (1.0, 1.0)},
        "its camera is at z": {"camera": dataclasses.replace(c.camera, origin=-c.camera.origin)},
    }
    for sentence, fields in cases.items():
        with pytest.raises(bk.BrdfkitError, match=sentence) as error:
            change(c, **fields)()
        assert "\n" not in str(error.value)


def test_a_light_behind_the_sample_is_refused(found):
    with pytest.raises(bk.BrdfkitError, match="above the sample"):
        found.relight((0, 0, -1))


@pytest.mark.parametrize(
    ("how", "sentence"),
    [
        ({"model": "gxg"}, "did you mean ggx"),
        ({"model": "koenderink"}, "below 0"),
        ({"fixed": {"f1": 0.1}}, "f0"),
        ({"fixed": {"f0": 2}}, "f0"),
        ({"resolution": 1}, "resolution"),
        ({"smoothness": 0}, "smoothness"),
    ],
)
def test_bad_arguments_are_one_sentence(made, how, sentence):
    with pytest.raises(bk.BrdfkitError, match=sentence):
        bk.photographs.svbrdf(made[1], **how)


NO_PLACE = "[sample]\nwidth = 1\nheight = 1\n[camera]\nfov = 60"
PLACES = f"{NO_PLACE}\norigin = [0, 0, 1]"
LIGHT = '[[light]]\npicture = "a.exr"\nposition = "camera"'
CROSSED = "{ corners = [[2, 2], [6, 6], [6, 2], [2, 6]] }"
BOTH = CROSSED.replace("{", "{ origin = [0, 0, 1],")
FILES = {
    "no capture.toml": (None, "there is no capture.toml"),
    "no TOML": ("[sample", "no TOML"),
    "no light": (
        "[sample]\nwidth = 1\nheight = 1\n[camera]\norigin = [0, 0, 1]\nfov = 60",
        "light",
    ),
    "a misspelt table": ("[smaple]\nwidth = 1", "'smaple'"),
    "no width": ("[sample]\nheight = 1", "width = None"),
    "no origin": (f"{NO_PLACE}\n{LIGHT}", "origin"),
    "an origin and corners": (f"{NO_PLACE}\n{LIGHT}\ncamera = {BOTH}", "one of them is enough"),
    "corners that are crossed": (f"{NO_PLACE}\n{LIGHT}\ncamera = {CROSSED}", "upper left"),
    "corners without an angle": (
        f"{NO_PLACE.replace('60', '0')}\n{LIGHT}\ncamera = {CROSSED}",
        "fov = 0 should be between 0 and 180",
    ),
    "three corners": (f"{NO_PLACE}\n{LIGHT}\ncamera = {{ corners = [[1, 2]] }}", "4 × 2"),
    "corners that are one": (f"{NO_PLACE}\n{LIGHT}\ncamera = {{ corners = 1 }}", "4 × 2"),
    "a camera that is no table": (f"{NO_PLACE}\n{LIGHT}\ncamera = 1", "should be a table"),
    "a misspelt entry": (f"{NO_PLACE}\n{LIGHT}\npower = 1", "[[light]] 1 has 'power'"),
    "8 bits": ('P\n[[light]]\npicture = "a.jpg"\nposition = "camera"', "8 bits"),
    "a picture that is missing": ('P\n[[light]]\npicture = "b.exr"\nposition = [0, 0, 1]', "b.exr"),
    "a place of one number": ('P\n[[light]]\npicture = "a.exr"\nposition = 1', "3 numbers"),
    "a picture that is named twice": (f"P\n{LIGHT}\n{LIGHT}", "a.exr is named twice"),
    "a camera that looks along up": (f"P\nup = [0, 1e-9, 1]\n{LIGHT}", "looks along up"),
    "a file of Notepad's": (f"\ufeffP\n{LIGHT}\npower = 1", "[[light]] 1 has 'power'"),
    "a number of 400 digits": (
        f"[sample]\nwidth = 1{400 * '0'}",
        "should be a number between -1e+30 and 1e+30",
    ),
    "a number of 5000 digits": (f"[sample]\nwidth = 1{5000 * '0'}", "it is no TOML"),
    "a place far away": (f"{NO_PLACE}\norigin = [0, 1e308, 1]\n{LIGHT}", "3 numbers below 1e30"),
    "a place that is none": ('P\n[[light]]\npicture = "a.jpg"\nposition = [0, 1]', "position"),
}


def test_a_camera_comes_back_from_corners():
    """From all around the sample, turned at will."""
    rng, size = np.random.default_rng(0), (0.1, 0.08)
    for _ in range(50):
        theta, phi = np.radians(rng.uniform(0, 70)), rng.uniform(0, 2 * np.pi)
        across = np.sin(theta)
        origin = rng.uniform(0.2, 1) * np.array(
            [across * np.cos(phi), across * np.sin(phi), np.cos(theta)]
        )
        target, up = rng.standard_normal((2, 3)) * [[0.02, 0.02, 0], [1, 1, 1]]
        camera = bk.photographs.Pinhole(origin, target, up, 40.0)
        places = camera.project(find_corners(size), (640, 480))
        found = find_camera(places, find_corners(size), (640, 480), 40.0)
        np.testing.assert_allclose(found.origin, origin, atol=1e-9)
        np.testing.assert_allclose(found.axes, camera.axes, atol=1e-9)


def test_a_camera_that_moves_with_its_flash(mi, tmp_path):
    """As phones take them; the places are said by the corners of the sample in the pictures."""
    truth = made_capture.Truth(TEXELS)
    rng = np.random.default_rng(1)
    positions, intensities = made_capture.lights(8, seed=5)
    cameras = [
        bk.photographs.Pinhole(place, np.zeros(3), rng.standard_normal(3), 22.0)
        for place in positions
    ]
    _, capture = made_capture.photographs(
        TEXELS, 8, truth=truth, lights_at=(positions, intensities), cameras=cameras
    )
    made_capture.write_capture(capture, tmp_path, by_corners=True)
    found = bk.photographs.svbrdf(tmp_path, resolution=TEXELS)
    np.testing.assert_allclose(found.capture.positions, positions, atol=1e-6)
    off = inner(found.maps["diffuse_reflectance"] - truth.maps["diffuse_reflectance"])
    assert np.sqrt((off**2).mean()) < 0.02
    off = inner(found.maps["normal"] - truth.maps["normal"])
    assert np.sqrt((off**2).mean()) < 0.02


def test_a_folder_that_is_missing_is_said(tmp_path):
    with pytest.raises(bk.BrdfkitError, match="no such folder"):
        bk.photographs.svbrdf(tmp_path / "nowhere")


@pytest.mark.parametrize("case", FILES)
def test_bad_folders_are_one_sentence_and_status_2(mi, case, tmp_path):
    text, sentence = FILES[case]
    (tmp_path / "a.jpg").write_bytes(b"")
    with use_two_threads():
        mi.Bitmap(np.zeros((8, 8, 3), np.float32)).write(str(tmp_path / "a.exr"))
    if text is not None:
        (tmp_path / "capture.toml").write_text(text.replace("P\n", f"{PLACES}\n"))
    result = CliRunner().invoke(main, ["svbrdf", str(tmp_path)])
    assert result.exit_code == 2
    assert sentence in " ".join(result.stderr.split())
    assert not (tmp_path / "maps").exists()
