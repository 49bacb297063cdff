"""`svbrdf` of odd photographs: each is fitted, or refused in a sentence."""

import dataclasses
import pickle
import subprocess
import sys

import made_capture
import numpy as np
import pytest

import brdfkit as bk
from brdfkit.inverse.photographs.arguments import to_texel_parameters
from brdfkit.inverse.photographs.maps.scene import format_scene_xml
from brdfkit.inverse.photographs.maps.undetermined import describe_undetermined
from brdfkit.inverse.photographs.search import coarse_to_fine

pytestmark = pytest.mark.filterwarnings("error")
TEXELS = 16


@pytest.fixture(scope="module")
def capture(mi):
    return made_capture.photographs(TEXELS, 8, pixels=32)[1]


def fit(capture, **how):
    return bk.photographs.svbrdf(capture, **{"resolution": TEXELS, "smoothness": 0.1} | how)


@pytest.fixture(scope="module")
def found(capture):
    return fit(capture)


def test_no_number_is_clipped_because_it_is_the_largest_of_few(capture, found):
    assert not capture.clipped.any()
    assert not found.notes


def test_lists_are_as_good_as_arrays(capture, found):
    camera = capture.camera
    vectors = (getattr(camera, name).tolist() for name in ("origin", "target", "up"))
    again = fit(
        bk.photographs.Capture(
            capture.pictures.tolist(),
            capture.positions.tolist(),
            capture.intensities.tolist(),
            bk.photographs.Pinhole(*vectors, 22),
            list(capture.size),
            list(capture.names),
            lost=np.zeros(capture.pictures.shape, int),  # not ~0
        )
    )
    for name, values in found.maps.items():
        np.testing.assert_allclose(again.maps[name], values, rtol=0, atol=1e-10)
    assert capture != dataclasses.replace(capture, positions=capture.positions + 1)


def part(values, k, value):
    changed = np.array(values)
    changed[k] = value
    return changed


ODD = {
    "no picture has a usable value of the sample": lambda c: {"lost": c.pictures > -1},
    "all is black, clipped, lost": lambda c: {"pictures": 0 * c.pictures},
    "positions: they should be finite": lambda c: {"positions": part(c.positions, 0, np.nan)},
    "none below": lambda c: {"intensities": part(c.intensities, 0, [1, -1, 1])},
    "intensities: they should be finite": lambda c: {"intensities": part(c.intensities, 0, np.inf)},
    "above 0 \\[m\\]": lambda c: {"size": (0.1, -0.1)},
    "size: their shape": lambda c: {"size": (0.1,)},
    "size: they should be numbers": lambda c: {"size": "ab"},
    "all different": lambda c: {"names": ("a",) * len(c.names)},
    "names: there should be 8": lambda c: {"names": ("a",)},
    "should be a Pinhole": lambda c: {"camera": None},
    "looks along up": lambda c: {
        "camera": bk.photographs.Pinhole([0, 0, 1], [0, 0, 0], [0, 0, 1], 20)
    },
    "fov = 190 should be between": lambda c: {"camera": dataclasses.replace(c.camera, fov=190)},
    "smaller than 8 pixels": lambda c: {"camera": dataclasses.replace(c.camera, fov=120)},
}


@pytest.mark.parametrize("sentence", ODD)
def test_odd_captures_are_one_sentence(capture, sentence):
    with pytest.raises(bk.BrdfkitError, match=sentence) as error:
        fit(dataclasses.replace(capture, **ODD[sentence](capture)))
    assert "\n" not in str(error.value)


UNUSABLE = {
    "black": lambda c: {"pictures": part(c.pictures, 3, 0)},
    "clipped": lambda c: {"pictures": part(c.pictures, 3, 9)},
    "grazing": lambda c: {"positions": part(c.positions, 3, [0.3, 0.3, 1e-3])},
}


@pytest.fixture(scope="module")
def found_without_one(capture):
    return fit(capture.select_lights(np.array([0, 1, 2, 4, 5, 6, 7])))


@pytest.mark.parametrize("case", UNUSABLE)
def test_a_photograph_that_shows_nothing_is_left_out(capture, found_without_one, case):
    """It has no weight, so that the maps are those of the other photographs."""
    odd = fit(dataclasses.replace(capture, **UNUSABLE[case](capture)))
    assert any("Left out: 03.exr, where" in note for note in odd.notes)
    assert len(odd.predicted) == 7
    for name, values in found_without_one.maps.items():
        np.testing.assert_allclose(odd.maps[name], values, rtol=0, atol=1e-6)


@pytest.mark.parametrize(
    ("how", "sentence"),
    [
        ({"fixed": {"f0": "a"}}, "f0 = 'a' should be a number"),
        ({"fixed": ["f0"]}, "fixed = .* should be a dictionary"),
        ({"smoothness": 1e-6}, "at least 0.003"),
        ({"capture": None}, "neither a folder nor a Capture"),
    ],
)
def test_odd_arguments_are_one_sentence(capture, how, sentence):
    with pytest.raises(bk.BrdfkitError, match=sentence):
        fit(**{"capture": capture} | how)


@pytest.mark.parametrize(
    "how",
    [
        {"position": "abc"},
        {"position": (0, 0, 1), "intensity": (1, 2)},
        {"position": (0, 0, 1), "intensity": np.nan},
        {"position": (0, 0, 1), "viewer": (0, 0, -1)},
    ],
)
def test_odd_lights_of_maps_are_one_sentence(found, how):
    with pytest.raises(bk.BrdfkitError):
        found.relight(**how)


@pytest.mark.parametrize("variant", ["llvm_ad_mono", "llvm_ad_spectral"])
def test_variants_without_colours_are_refused(mi, capture, variant):
    mi.set_variant(variant)
    try:
        with pytest.raises(bk.BrdfkitError, match="set llvm_ad_rgb"):
            fit(capture)
    finally:
        mi.set_variant("llvm_ad_rgb")


def test_a_sample_of_a_millimetre(mi, capture, found):
    """Mitsuba's cameras see nothing within 1 cm, unless they are told."""
    s = 0.01
    origin = s * capture.camera.origin
    small = dataclasses.replace(
        capture,
        positions=s * capture.positions,
        intensities=s**2 * capture.intensities,
        camera=dataclasses.replace(capture.camera, origin=origin),
        size=(s * 0.1, s * 0.1),
    )
    again = fit(small)
    for name, values in found.maps.items():
        np.testing.assert_allclose(again.maps[name], values, atol=0.002)
    assert "near_clip" in format_scene_xml(again, {name: name for name in again.maps})


def test_fresnel_reflectances_of_sums_are_alike_everywhere():
    assert to_texel_parameters("ggx+ggx", False, {}).fixed == {"ggx_1_f0": 0.5, "ggx_2_f0": 0.5}


@pytest.mark.parametrize("finished", [0, 1, 2])
def test_ctrl_c_of_maps_that_are_not_square(capture, monkeypatch, finished):
    """33 texels were made of 3, each 11 large, not 16, and the lower ones were missing."""
    original, calls = coarse_to_fine.fit_with_restarts, []

    def stop(*args):
        calls.append(args)
        if len(calls) > finished:
            raise KeyboardInterrupt
        return original(*args)

    monkeypatch.setattr(coarse_to_fine, "fit_with_restarts", stop)
    with pytest.raises(bk.Interrupted) as stopped:
        fit(dataclasses.replace(capture, size=(0.1, 0.09)), resolution=33)
    assert stopped.value.best.shape == (30, 33)


def test_maps_that_were_pickled_can_be_shown_in_another_process(found, tmp_path):
    """Where no variant of Mitsuba's is set yet."""
    (tmp_path / "maps").write_bytes(pickle.dumps(found))
    code = "import pickle, sys; print(*pickle.loads(open(sys.argv[1], 'rb').read()).scene_dict())"
    said = subprocess.run(
        [sys.executable, "-c", code, tmp_path / "maps"], capture_output=True, text=True
    )
    assert "bsdf" in said.stdout, said.stderr


def test_light_of_one_colour(capture, found):
    """What it shows is as it was; of the other colours nothing is said but that."""
    red = np.array([1.0, 0, 0])
    pictures, intensities = capture.pictures * red, capture.intensities * red
    alone = fit(dataclasses.replace(capture, pictures=pictures, intensities=intensities))
    assert alone.notes == ("Nothing is seen in green and blue: there the maps say nothing.",)
    off = alone.maps["diffuse_reflectance"] - found.maps["diffuse_reflectance"]
    assert np.sqrt((off[3:-3, 3:-3, 0] ** 2).mean()) < 0.01
    assert np.median(alone.uncertainty["alpha_u"]) < 3 * np.median(found.uncertainty["alpha_u"])


def test_texels_finer_than_pixels_are_said(capture):
    notes = fit(capture, resolution=2 * TEXELS + 1).notes
    assert any("A pixel is 1.4 texels long" in note for note in notes)


def test_one_number_that_is_open_is_not_apart():
    numbers = to_texel_parameters("oren_nayar", False, {})
    hessian = np.tile(np.eye(numbers.count), (4, 1, 1))
    hessian[:2, numbers.shape_columns] = 0
    (said,) = describe_undetermined(numbers, hessian, 8)
    assert "do not tell sigma: there" in said


def test_what_is_clipped_is_said_of_photographs_that_are_made_smaller(mi):
    _, capture = made_capture.photographs(TEXELS, 4, pixels=200)
    pictures = np.minimum(capture.pictures, np.quantile(capture.pictures, 0.998))
    found = fit(dataclasses.replace(capture, pictures=pictures), resolution=8)
    assert found.capture.picture_size[0] < 100
    assert any("% of the pixels are clipped" in note for note in found.notes)


@pytest.mark.parametrize("turned", [(1, 1), (1, -1), (-1, -1)])
def test_normals_of_what_is_no_flat_sample_are_said(mi, turned):
    """Pictures that are mirrored, or turned, look like those of a bowl."""
    _, capture = made_capture.photographs(32, 12)
    pictures = capture.pictures[:, :: turned[0], :: turned[1]]
    notes = fit(dataclasses.replace(capture, pictures=pictures), resolution=32).notes
    assert any("the sample is not flat" in note for note in notes) == (turned != (1, 1))


def test_a_full_disk_is_one_sentence(mi, found, monkeypatch, tmp_path):
    class Full:
        def __init__(self, pixels):
            pass

        def write(self, path):
            raise RuntimeError("[FileStream] no space left")

    monkeypatch.setattr(mi, "Bitmap", Full)
    with pytest.raises(bk.BrdfkitError, match="cannot be written"):
        found.write(tmp_path)
    assert not list(tmp_path.iterdir())
