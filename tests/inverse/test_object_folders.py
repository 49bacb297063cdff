"""Folders of photographs of an object: each kind is read alike, and each trap is said."""

import sys

import numpy as np
import pytest
from made_objects import Made, ball, directions, rows, shade, write_mask, write_png
from PIL import Image

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit.threads import use_two_threads
from brdfkit.inverse.photographs.capture.capture import Capture
from brdfkit.inverse.photographs.capture.diagnosis.lambert import fit_lambert
from brdfkit.inverse.photographs.capture.folders import list_kinds
from brdfkit.inverse.photographs.capture.load_photographs import load_photographs
from brdfkit.inverse.photographs.capture.pictures.coding import Coding, to_coding
from brdfkit.inverse.photographs.capture.pictures.masks import read_mask
from brdfkit.inverse.photographs.capture.pictures.photograph_file import read_linear
from brdfkit.inverse.photographs.capture.reading import ALMOST
from brdfkit.materials.collections import public

pytestmark = pytest.mark.usefixtures("mi")
KINDS = ("diligent", "series", "psbox", "rti", "table", "turned_table", "named_table", "toml")


def angles(a, b):
    """Angles [degrees] between rows of two arrays."""
    cosine = (a * b).sum(axis=1) / np.linalg.norm(a, axis=1) / np.linalg.norm(b, axis=1)
    return np.degrees(np.arccos(np.clip(cosine, -1, 1)))


def find_normals(capture):
    lights = capture.lights.directions * capture.lights.intensities[:, :1]
    values = capture.values.mean(axis=2)
    return fit_lambert(values, np.ones(values.shape, bool), lights).scaled_normals


def check_normals(capture, degrees=0.5):
    """The normals by Lambert's law are those of the ball, wherever shadows are few."""
    truth = ball()[1][capture.mask]
    facing = truth[:, 2] > 0.6
    assert angles(find_normals(capture), truth)[facing].max() < degrees


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_of_folder(kind, tmp_path):
    made = Made()
    capture = load_photographs(getattr(made, kind)(tmp_path / "ball"))
    order = [int(name.split("_")[1].split(".")[0]) for name in capture.names]
    assert sorted(order) == list(range(12))
    assert angles(capture.lights.directions, made.lights[order]).max() < 1e-3
    np.testing.assert_array_equal(capture.mask, ball()[0])
    np.testing.assert_allclose(
        capture.values, shade(made.lights)[order][:, ball()[0]], rtol=0, atol=1e-5
    )
    assert capture.values.dtype == np.float32
    assert not capture.notes
    check_normals(capture)


@pytest.mark.parametrize("kind", ["series_beside_chrome", "probes"])
def test_lights_from_a_chrome_ball(kind, tmp_path):
    made = Made()
    capture = load_photographs(getattr(made, kind)(tmp_path / "ball"))
    assert angles(capture.lights.directions, made.lights).max() < 2
    assert ["found from" in note for note in capture.notes] == [True]


def test_a_folder_may_be_the_one_of_objects_in_psbox(tmp_path):
    folder = Made().psbox(tmp_path / "data")
    assert (
        load_photographs(folder / "Objects").values.shape == load_photographs(folder).values.shape
    )


def test_every_kind_has_a_name():
    assert len({kind.NAME for kind in list_kinds()}) == len(list_kinds()) == 6


def test_true_normals_of_diligent(tmp_path):
    from scipy.io import savemat

    folder = Made(strengths=np.linspace(0.4, 1, 12)).diligent(tmp_path / "ball")
    savemat(folder / "Normal_gt.mat", {"Normal_gt": ball()[1]})
    capture = load_photographs(folder)
    np.testing.assert_allclose(capture.normals, ball()[1][capture.mask])
    assert not capture.notes
    check_normals(capture)


def test_lamps_of_a_capture_file(tmp_path):
    made = Made(directions(4))
    made.write_photographs(tmp_path)
    lights = [
        f'[[light]]\npicture = "{name}"\nposition = {list(map(float, vector))}'
        for name, vector in zip(made.names, made.lights, strict=True)
    ]
    lights[0] += "\naxis = [0, 0, -2]\nexponent = 2"
    lights[3] = '[[light]]\npicture = "ball_3.png"\nposition = "camera"'
    text = "[object]\nwidth = 0.39\n[camera]\ndistance = 0.5\n" + "\n".join(lights)
    (tmp_path / "capture.toml").write_text(text)
    capture = load_photographs(tmp_path)
    assert capture.pixel_size == pytest.approx(0.01)  # the ball is 39 pixels wide
    assert capture.distance == 0.5
    np.testing.assert_allclose(capture.lights.positions[:3], made.lights[:3])
    np.testing.assert_array_equal(capture.lights.positions[3], [0, 0, 0.5])
    np.testing.assert_array_equal(capture.lights.exponents, [2, 0, 0, 0])
    np.testing.assert_array_equal(capture.lights.axes[0], [0, 0, -1])


def test_the_focal_length_of_exif_tells_the_distance(tmp_path):
    made = Made(directions(4))
    made.write_photographs(tmp_path)
    for name, picture in zip(made.names, shade(made.lights), strict=True):
        exif = Image.Exif()
        exif.get_ifd(0x8769)[41989] = 50
        whole = np.round(picture * 255).astype(np.uint8)
        Image.fromarray(whole).save(tmp_path / name.replace("png", "jpg"), exif=exif, quality=98)
    lights = [
        f'[[light]]\npicture = "{name.replace("png", "jpg")}"\ndirection = {list(map(float, v))}'
        for name, v in zip(made.names, made.lights, strict=True)
    ]
    (tmp_path / "capture.toml").write_text("[object]\npixel_size = 1e-3\n" + "\n".join(lights))
    capture = load_photographs(tmp_path, "linear")
    diagonal = np.hypot(48, 48) * 1e-3
    assert capture.distance == pytest.approx(50 / 43.27 * diagonal)
    assert "50 mm" in capture.notes[0]


# ---- formats


def write_exr(path, values):
    import mitsuba as mi

    with use_two_threads():
        mi.Bitmap(values.astype(np.float32)).write(str(path))


def write_tiff(bits, **how):
    import tifffile

    def write(path, values):
        kind = {8: np.uint8, 16: np.uint16}[bits]
        whole = np.round(values * (2**bits - 1)).astype(kind)
        whole = np.moveaxis(whole, 2, 0) if "planarconfig" in how else whole
        tifffile.imwrite(path, whole, **how)

    return write


FORMATS = {
    "a.exr": (write_exr, 1e-6),
    "a.png": (write_png, 1e-5),
    "grey.png": (lambda path, values: write_png(path, values[..., :1]), 1e-5),
    "deep.tif": (write_tiff(16), 1e-5),
    "deep.tiff": (write_tiff(16, compression="zlib", byteorder=">"), 1e-5),
    "planes.tif": (write_tiff(16, photometric="rgb", planarconfig="separate"), 1e-5),
    "flat.tif": (write_tiff(8), 1 / 255),
    "8.png": (lambda path, values: write_png(path, values, 8), 1 / 255),
}


@pytest.mark.parametrize("name", FORMATS)
def test_every_format_of_photographs(name, tmp_path):
    write, error = FORMATS[name]
    values = np.random.default_rng(0).random((9, 7, 3))
    values[2, 3] = 1
    write(tmp_path / name, values)
    found, largest = read_linear(tmp_path / name, to_coding("linear"))
    expected = np.repeat(values[..., :1], 3, axis=2) if name == "grey.png" else values
    np.testing.assert_allclose(found, expected, rtol=0, atol=error)
    assert largest == (np.inf if name == "a.exr" else 1)
    assert found.dtype == np.float32


@pytest.mark.parametrize("mode", ["1", "L", "P", "RGBA"])
@pytest.mark.parametrize("suffix", [".png", ".tif"])
def test_masks_of_every_kind(mode, suffix, tmp_path):
    mask = ball()[0]
    Image.fromarray(mask.astype(np.uint8) * 255).convert(mode).save(tmp_path / f"mask{suffix}")
    np.testing.assert_array_equal(read_mask(tmp_path / f"mask{suffix}"), mask)


def test_raw_files_are_linear(tmp_path):
    pytest.importorskip("rawpy")
    from made_raw import write_dng

    values = np.full((64, 64, 3), 0.5) * [0.5, 1, 0.6]
    values[:, 32:] *= 0.5
    values[:8, :8] = 1
    write_dng(tmp_path / "a.dng", values)
    found, _ = read_linear(tmp_path / "a.dng", to_coding("sRGB"))  # not for RAW files
    np.testing.assert_allclose(found[32, 16] / found[32, 48], 2, rtol=1e-3)
    np.testing.assert_allclose(found[32, 16], 0.5, rtol=1e-3)
    assert (found[3, 3] > ALMOST).all()


def test_a_missing_package_is_said_before_the_work(tmp_path, monkeypatch):
    folder = Made(directions(3)).table(tmp_path)
    (folder / "ball_2.png").rename(folder / "ball_2.nef")
    (folder / "ball_0.png").write_bytes(b"damaged")
    monkeypatch.setitem(sys.modules, "rawpy", None)
    with pytest.raises(BrdfkitError, match=r"needs the package rawpy.*brdfkit\[raw\]"):
        load_photographs(folder)


@pytest.mark.parametrize("word", ["sRGB", "gamma", "2.2", 2.2, "linear"])
def test_codings(word):
    values = np.linspace(0, 1, 100)
    coded = {
        "sRGB": np.where(values < 0.0031308, 12.92 * values, 1.055 * values ** (1 / 2.4) - 0.055),
        "linear": values,
    }.get(word, values ** (1 / 2.2))
    np.testing.assert_allclose(to_coding(word).decode(coded), values, atol=1e-5)


def test_other_codings_are_refused():
    for word in "sgrb", "0.45", 7, True, "nan":
        with pytest.raises(BrdfkitError, match="linear, sRGB, gamma"):
            to_coding(word)
    assert to_coding(None) is None
    assert Coding() == to_coding("Linear ")


# ---- what is odd is corrected, and said


MIRRORS = {
    "y points down": np.diag([1, -1, 1]),
    "x points to the left": np.diag([-1, 1, 1]),
    "z points away": np.diag([1, 1, -1]),
    "light travels": -np.eye(3),
    "x and y are swapped": np.array([[0, 1, 0], [1, 0, 0], [0, 0, 1]]),
    "rows and columns": np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]]),
}


@pytest.mark.parametrize("name", MIRRORS)
def test_lights_in_other_axes_are_turned(name, tmp_path):
    made = Made()
    made.stated = made.lights @ MIRRORS[name].T
    capture = load_photographs(made.table(tmp_path))
    np.testing.assert_allclose(capture.lights.directions, made.lights, atol=1e-6)
    assert len(capture.notes) == 1
    assert "outline" in capture.notes[0]
    assert capture.notes[0].count("y") >= 1


def test_rows_in_the_order_of_text(tmp_path):
    made = Made()
    made.stated = made.lights[sorted(range(12), key=str)]  # 0, 1, 10, 11, 2 and so on
    capture = load_photographs(made.table(tmp_path))
    np.testing.assert_allclose(capture.lights.directions, made.lights, atol=1e-6)
    assert ["alphabetical order" in note for note in capture.notes] == [True]


def test_shuffled_lights_are_said(tmp_path):
    made = Made()
    made.stated = made.lights[np.random.default_rng(0).permutation(12)]
    capture = load_photographs(made.diligent(tmp_path))
    assert "hardly explain the photographs" in capture.notes[-1]


def test_a_bowl_is_not_taken_for_a_ball(tmp_path):
    made = Made()
    made.stated = made.lights * [-1, -1, 1]
    capture = load_photographs(made.table(tmp_path))
    np.testing.assert_allclose(capture.lights.directions, made.stated, atol=1e-6)
    assert "hollow" in capture.notes[0]


@pytest.mark.parametrize(
    ("power", "bits", "linearise", "said"),
    [
        (1 / 2.2, 16, None, "seem to be coded with a gamma"),
        (1 / 2.2, 16, "gamma", None),
        (1 / 2.2, 8, "linear", "seem to be coded with a gamma"),
        (1 / 2.2, 8, 2.2, None),
        (1, 8, "linear", None),
        (1, 8, "sRGB", "seem to have been linear"),
    ],
)
def test_the_coding_of_photographs(power, bits, linearise, said, tmp_path):
    notes = load_photographs(Made(power=power, bits=bits).diligent(tmp_path), linearise).notes
    assert [said in note for note in notes] == ([True] if said else [])


@pytest.mark.parametrize(("power", "word"), [(1 / 2.2, "look like sRGB"), (1, "look like linear")])
def test_8_bits_are_refused_with_advice(power, word, tmp_path):
    with pytest.raises(BrdfkitError, match=f"ball_0.png: it has 8 bits; .*{word}"):
        load_photographs(Made(power=power, bits=8).table(tmp_path))


def test_unequal_lights_are_estimated_where_no_file_has_them(tmp_path):
    strengths = np.linspace(0.4, 1, 12)
    capture = load_photographs(Made(strengths=strengths).table(tmp_path))
    found = capture.lights.intensities[:, 0]
    np.testing.assert_allclose(found / found.mean(), strengths / strengths.mean(), rtol=0.01)
    assert "states no intensities" in capture.notes[0]
    check_normals(capture)


def test_photographs_that_are_divided_by_intensities_already(tmp_path):
    folder = Made().diligent(tmp_path)
    strengths = np.linspace(0.4, 1, 12)[:, None] * np.ones(3)
    (folder / "light_intensities.txt").write_text(rows(strengths))
    capture = load_photographs(folder)
    np.testing.assert_array_equal(capture.lights.intensities, 1)
    assert "divided by the intensities" in capture.notes[0]


def test_unlit_photographs_and_lights_behind_are_left_out(tmp_path):
    made = Made()
    made.stated = made.lights.copy()
    made.stated[4, 2] *= -1
    folder = made.table(tmp_path)
    write_png(folder / "ball_7.png", np.zeros((48, 48, 3)))
    capture = load_photographs(folder)
    assert len(capture.names) == len(capture.values) == len(capture.lights) == 10
    assert [note.split(": ")[1] for note in capture.notes] == ["ball_7.png.", "ball_4.png."]


def test_clipped_values_are_lost(tmp_path):
    made = Made()
    bright = np.minimum(2 * shade(made.lights), [0.9, 1, 0.7])  # after a white balance
    made.write_photographs(tmp_path, bright)
    (tmp_path / "lights.txt").write_text(rows(made.lights))
    capture = load_photographs(tmp_path)
    clipped = bright[:, capture.mask] >= [0.9, ALMOST, 0.7]
    assert clipped[..., :2].any(axis=(0, 1)).all()
    np.testing.assert_array_equal(capture.lost[..., :2], clipped[..., :2])


@pytest.mark.parametrize(("power", "said"), [(-2, "positions"), (1, "strengths"), (0, "not used")])
@pytest.mark.parametrize("kind", ["rti", "table"])
def test_lengths_of_vectors(kind, power, said, tmp_path):
    made = Made()
    lengths = np.linspace(1, 2, 12)
    made.strengths = lengths**power / max(1, 2**power)
    made.stated = 70 * lengths[:, None] * made.lights
    capture = load_photographs(getattr(made, kind)(tmp_path))
    assert [said in note for note in capture.notes] == [True]
    check_normals(capture)


def test_an_object_without_a_mask(tmp_path):
    made = Made(mask=False)
    pictures = shade(made.lights) + 0.01 * np.random.default_rng(0).random((12, 48, 48, 3))
    made.write_photographs(tmp_path, pictures)
    (tmp_path / "lights.txt").write_text(rows(made.lights))
    capture = load_photographs(tmp_path)
    assert (capture.mask != ball()[0]).mean() < 0.02
    assert "there is no mask" in capture.notes[0]


# ---- errors


def change(name, function):
    """Return a change to a folder: a file's text becomes what a function makes of it."""

    def apply(folder):
        path = folder / name
        path.write_text(function(path.read_text()))

    return apply


def replace_picture(values):
    return lambda folder: write_png(folder / "ball_3.png", values)


TRAPS = {
    "a light too few": (
        "table",
        change("light_directions.csv", lambda t: t[: t[:-1].rindex("\n") + 1]),
        "it has 11 lights, and there are 12 photographs",
    ),
    "an intensity too few": (
        "diligent",
        change("light_intensities.txt", lambda t: t[: t[:-1].rindex("\n") + 1]),
        "intensities of 11 lights",
    ),
    "a negative intensity": (
        "diligent",
        change("light_intensities.txt", lambda t: "-" + t),
        "above 0",
    ),
    "nan": ("diligent", change("light_directions.txt", lambda t: f"nan{t[10:]}"), "not finite"),
    "a zero vector": (
        "diligent",
        change("light_directions.txt", lambda t: f"0 0 0\n{t.partition(chr(10))[2]}"),
        "light 1 has no direction",
    ),
    "a word": (
        "diligent",
        change("light_directions.txt", lambda t: t + "a b c"),
        "'a' is no number",
    ),
    "two columns": (
        "diligent",
        change("light_directions.txt", lambda t: "1 2\n" * 12),
        "x, y and z",
    ),
    "an empty file": ("diligent", change("light_directions.txt", lambda t: ""), "no numbers"),
    "binary": (
        "diligent",
        lambda f: (f / "light_directions.txt").write_bytes(b"\xff\xfe\x80"),
        "no text",
    ),
    "lights in a plane": (
        "diligent",
        change("light_directions.txt", lambda t: "".join(f"0 {k} 9\n" for k in range(12))),
        "lie in one plane",
    ),
    "lights behind": (
        "diligent",
        change("light_directions.txt", lambda t: rows(directions() * np.tile([[1], [-1]], (6, 1)))),
        "6 of 12 lights are behind the object",
    ),
    "a photograph that is missing": (
        "diligent",
        lambda folder: (folder / "ball_5.png").unlink(),
        "ball_5.png: there is no such file",
    ),
    "a photograph of another size": (
        "table",
        replace_picture(np.ones((48, 50, 3))),
        "it has 50 × 48 pixels, and the mask 48 × 48",
    ),
    "a damaged photograph": (
        "table",
        lambda folder: (folder / "ball_3.png").write_bytes(b"\x89PNG\r\n\x1a\n"),
        "ball_3.png",
    ),
    "an empty mask": (
        "table",
        lambda folder: write_mask(folder / "mask.png", np.zeros((48, 48), bool)),
        "0 of its pixels are white",
    ),
    "a mask of another size": (
        "table",
        lambda folder: write_mask(folder / "mask.png", np.ones((40, 48), bool)),
        "the mask 48 × 40",
    ),
    "two masks": ("table", lambda f: write_mask(f / "ball_mask.png"), "could both be the mask"),
    "two tables": (
        "table",
        lambda folder: (folder / "directions.txt").write_text("1 2 3"),
        "could both be the table of lights",
    ),
    "two kinds": (
        "diligent",
        lambda folder: (folder / "a.lp").write_text("1\nball_0.png 0 0 1"),
        "it could be DiLiGenT or a file .lp",
    ),
    "a name of nobody": (
        "named_table",
        change("lights.csv", lambda t: t.replace("ball_4", "bell_4")),
        "did you mean ball_4.png",
    ),
    "a count that is wrong": (
        "rti",
        change("ball.lp", lambda t: t.replace("12", "13", 1)),
        "promises 13",
    ),
    "no count": ("rti", change("ball.lp", lambda t: t.partition("\n")[2]), "number of photographs"),
    "a line that is odd": ("rti", change("ball.lp", lambda t: t + " x"), "line 13"),
    "a series without a mask": (
        "series",
        change("ball.txt", lambda t: t.replace("\nmask.png", "")),
        "and 11 names follow",
    ),
    "no normals": (
        "diligent",
        lambda folder: (folder / "Normal_gt.mat").write_bytes(b"no mat"),
        "no file of Matlab",
    ),
    "no direction": (
        "toml",
        change("capture.toml", lambda t: t.replace("direction", "# ")),
        "either",
    ),
    "a lamp among distant lights": (
        "toml",
        change("capture.toml", lambda t: t.replace("direction", "position", 1)),
        "one kind for all",
    ),
    "lamps without a scale": (
        "toml",
        change("capture.toml", lambda t: t.replace("direction", "position")),
        "give [object] width",
    ),
    "a flash without a distance": (
        "toml",
        change("capture.toml", lambda t: t[: t.index("direction")] + 'position = "camera"'),
        "give [camera] distance",
    ),
    "a sample and an object": (
        "toml",
        change("capture.toml", lambda t: "[sample]\n" + t),
        "leave the one",
    ),
    "a misspelt key": (
        "toml",
        change("capture.toml", lambda t: t.replace("[object]", "[object]\nmsk = 1")),
        "known are name, mask",
    ),
}


@pytest.mark.parametrize("name", TRAPS)
def test_traps_are_one_sentence(name, tmp_path):
    kind, spoil, sentence = TRAPS[name]
    folder = getattr(Made(), kind)(tmp_path / "ball")
    spoil(folder)
    with pytest.raises(BrdfkitError) as error:
        load_photographs(folder)
    assert sentence in str(error.value)
    assert str(tmp_path) in str(error.value)
    assert "\n" not in str(error.value)


def write_without_lights(folder, count, **how):
    made = Made(directions(count), **how)
    made.write_photographs(folder)
    return folder


def test_lights_that_nobody_states_are_estimated(tmp_path):
    strengths = np.linspace(1, 0.8, 12)
    folder = write_without_lights(tmp_path, 12, strengths=strengths, texture=0.05)
    capture = load_photographs(folder)
    assert np.median(angles(capture.lights.directions, directions())) < 5
    found = capture.lights.intensities[:, 0]
    np.testing.assert_allclose(found / found.mean(), strengths / strengths.mean(), rtol=0.05)
    assert ["they were estimated from the photographs" in note for note in capture.notes] == [True]


def test_few_photographs_without_lights_are_refused(tmp_path):
    with pytest.raises(BrdfkitError, match=r"no capture.toml in it, nor .* its 5 photographs"):
        load_photographs(write_without_lights(tmp_path, 5))


def test_a_folder_of_folders_names_one_with_photographs(tmp_path):
    with pytest.raises(BrdfkitError, match=r"no photographs in it; give .* has them\.$"):
        load_photographs(tmp_path)
    Made().table(tmp_path / "ball")
    with pytest.raises(BrdfkitError, match=r"such as .*ball"):
        load_photographs(tmp_path)


def test_lights_of_an_object_without_an_outline_are_not_estimated(tmp_path):
    write_without_lights(tmp_path, 6, mask=False)
    write_mask(tmp_path / "mask.png", np.ones((48, 48), bool))
    with pytest.raises(BrdfkitError, match="if the outline of the object is in the photographs"):
        load_photographs(tmp_path)


def test_8_bits_without_lights(tmp_path):
    with pytest.raises(BrdfkitError, match=r"it has 8 bits; give --linearise"):
        load_photographs(write_without_lights(tmp_path, 12, bits=8))


def test_a_table_of_any_name(tmp_path):
    folder = Made().turned_table(tmp_path)
    (folder / "lights.txt").rename(folder / "L.txt")
    (folder / "README.txt").write_text("3 balls\n1 2 3")
    np.testing.assert_allclose(load_photographs(folder).lights.directions, directions(), atol=1e-6)


def test_a_flat_sample_in_a_png_of_16_bits(tmp_path):
    values = np.random.default_rng(0).random((20, 24, 3))
    write_png(tmp_path / "a.png", values)
    (tmp_path / "capture.toml").write_text(
        "[sample]\nwidth = 0.1\nheight = 0.08\n[camera]\norigin = [0, 0, 0.5]\nfov = 20\n"
        '[[light]]\npicture = "a.png"\nposition = "camera"'
    )
    capture = load_photographs(tmp_path)
    assert isinstance(capture, Capture)
    np.testing.assert_allclose(capture.pictures[0], values, atol=1e-5)


def test_two_lights_are_too_few(tmp_path):
    with pytest.raises(BrdfkitError, match="only 2 photographs"):
        load_photographs(Made(directions(2)).table(tmp_path))


def test_a_mask_of_a_chrome_ball_is_a_disc(tmp_path):
    folder = Made().series_beside_chrome(tmp_path / "ball")
    write_mask(tmp_path / "chrome" / "mask.png", np.arange(48) < np.full((48, 1), 12))
    with pytest.raises(BrdfkitError, match="is no disc, as it is 12 × 48"):
        load_photographs(folder)


def test_a_downloaded_folder_is_found_by_its_name(tmp_path, monkeypatch):
    monkeypatch.setattr(public, "find_cache_folder", lambda: tmp_path)
    monkeypatch.chdir(tmp_path)
    with pytest.raises(BrdfkitError, match="run 'brdfkit data get captures/psbox-cat'"):
        load_photographs("captures/psbox-cat")
    made = Made(mask=False).psbox(tmp_path / "captures" / "psbox-cat")
    for k in range(12):
        name = made / "Objects" / f"ball_{k}.png"
        name.rename(made / "Objects" / f"Image_{k + 1:02d}.png")
    (tmp_path / "here" / "captures" / "psbox-cat" / "maps").mkdir(parents=True)
    monkeypatch.chdir(tmp_path / "here")
    assert load_photographs("captures/psbox-cat").name == "psbox-cat"
