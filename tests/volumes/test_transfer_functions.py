"""Transfer functions: their points, opacity and extinction, files, presets, and bad ones."""

import json
from dataclasses import replace

import numpy as np
import pytest

import brdfkit as bk
from brdfkit.core.colours import from_srgb, to_srgb
from brdfkit.core.errors import BrdfkitError
from brdfkit.volumes.transfer import opacity
from brdfkit.volumes.transfer.files import list_presets

TF = bk.volumes.TransferFunction
pytestmark = pytest.mark.quick
RAMP = TF([0, 10, 30], [[0, 0, 0, 0], [1, 0.5, 0, 0.25], [1, 1, 1, 1]], 2.0, value_unit="HU")
SLICER = """<MRML><VolumeProperty name="CT-A" scalarOpacity="8 0 0 100 0.5 100 0.9 300 1"
 colorTransfer="8 0 0 0 0 300 1 0.5 0" gradientOpacity="4 0 0 50 1"/>
 <VolumeProperty name="B" scalarOpacity="4 0 0.5 1 0.5" colorTransfer="8 0 1 1 1 1 1 1 1"
 gradientOpacity="4 0 1 255 1"/></MRML>"""


def test_linear_between_points_and_constant_beyond():
    at = np.array([-5, 0, 5, 20, 30, 99])
    for channel in range(4):
        expected = np.interp(at, RAMP.values, RAMP.rgba[:, channel])
        np.testing.assert_allclose(RAMP(at)[:, channel], expected)
    assert RAMP(np.zeros((2, 3))).shape == (2, 3, 4)
    np.testing.assert_allclose(RAMP(5), [0.5, 0.25, 0, 0.125])
    assert str(RAMP) == (
        "transfer function: 0 to 30 HU, RGB is albedo, extinction 2 per unit of length"
    )


def test_two_points_at_one_value_are_a_step():
    step = TF([0, 1, 1, 2], [[0, 0, 0, 0], [0, 0, 0, 0], [1, 1, 1, 1], [1, 1, 1, 1]])
    assert step([0.999, 1, 1.001])[:, 3].tolist() == [0, 1, 1]
    assert TF([0, 1, 1], step.rgba[:3])([0.5, 1, 2])[:, 3].tolist() == [0, 1, 1]


def test_the_table_has_both_ends():
    table = RAMP.table(7)
    assert (table.dtype, table.shape) == (np.float32, (7, 4))
    np.testing.assert_allclose(table, RAMP(np.linspace(0, 30, 7)), rtol=1e-6)


def test_two_dimensions():
    """A ramp of gradients is the product exactly; a full table is bilinear."""
    edges = RAMP.over_gradients([(10, 0), (20, 1)])
    v, g = np.random.default_rng(0).uniform(0, 30, (2, 100))
    np.testing.assert_allclose(edges(v, g)[:, :3], RAMP(v)[:, :3])
    factor = np.interp(g, [10, 20], [0, 1])
    np.testing.assert_allclose(edges(v, g)[:, 3], RAMP(v)[:, 3] * factor, atol=1e-12)
    assert (edges.gradient_range, RAMP.gradient_range) == ((10, 20), None)
    assert edges.table(5, 3).shape == (3, 5, 4)
    np.testing.assert_allclose(edges.table(5, 3)[2], RAMP.table(5), rtol=1e-6)
    rgba = np.random.default_rng(1).random((2, 2, 4))
    full = TF([0, 1], rgba, gradients=[0, 4])
    by_value = 0.75 * rgba[:, 0] + 0.25 * rgba[:, 1]
    np.testing.assert_allclose(full(0.25, 3), [0.25, 0.75] @ by_value)
    with pytest.raises(BrdfkitError, match="depends on gradient magnitudes; give them"):
        edges(v)


def test_scaling_to_another_range():
    scaled = RAMP.over_gradients([(0, 0), (3, 1)]).scaled_to(-1, 1)
    assert (scaled.range, scaled.value_unit) == ((-1, 1), "")
    np.testing.assert_allclose(scaled.gradients, [0, 0.2])
    np.testing.assert_allclose(scaled(0, 9), RAMP(15))


def test_lengths_in_another_unit():
    """An extinction of 2 per mm is one of 0.002 per µm; pixels have no length."""
    bone = replace(TF.load("mri_edges"), extinction=2.0)
    fine = bone.per("um")
    assert fine.extinction == pytest.approx(0.002)
    np.testing.assert_allclose(fine.gradients, bone.gradients / 1000)
    assert "extinction 0.002 per um" in str(fine)
    assert fine.per("mm").extinction == pytest.approx(2)
    assert bone.per("mm") is bone
    for function, unit in ((bone, "pixels"), (replace(bone, length_unit=""), "mm")):
        with pytest.raises(BrdfkitError, match=f"cannot be converted to 1/{unit}: units are m, "):
            function.per(unit)
    image = bk.volumes.Volume(np.ones((2, 2, 2)), unit="pixels")
    with pytest.raises(BrdfkitError, match="extinction is per mm, which cannot"):
        image.scene_dict("mri_head")


def test_opacity_of_a_layer_becomes_extinction():
    """exp(-σ_t d) = 1 - a at every value, as in VTK for samples at any distance."""
    values, a = np.array([0, 1, 1, 2, 5]), np.array([0, 0.5, 0.1, 1, 0.7])
    rgba = np.column_stack([values / 5, a, 1 - a, a])
    for distance in (0.5, 3.0):
        function = TF.from_opacity(values, rgba, unit_distance=distance)
        at = np.setdiff1d(np.linspace(0, 5, 4001), values)
        sigma = function.extinction * function(at)[:, 3]
        given = TF(values, rgba, colour="emission")
        exact = opacity.opacity_to_extinction(given(at)[:, 3], distance)
        assert np.abs(sigma - exact).max() <= 1.001e-5 * function.extinction
        np.testing.assert_allclose(function(at)[:, :3], given(at)[:, :3], atol=1e-9)
        sample = 0.1  # VTK: 1 - (1 - a)^(s / d)
        vtk = 1 - (1 - np.minimum(given(at)[:, 3], opacity.OPAQUE)) ** (sample / distance)
        np.testing.assert_allclose(opacity.extinction_to_opacity(exact, sample), vtk, rtol=1e-9)
    half = TF.from_opacity([0, 1], [[1, 1, 1, 0.5]] * 2, unit_distance=2)
    assert half.extinction == pytest.approx(np.log(2) / 2)
    assert len(half.values) == 2
    assert TF.from_opacity([0, 1], np.zeros((2, 4))).extinction == 1


def test_colour_maps_are_made_linear():
    import matplotlib

    function = TF.from_colormap(
        "viridis", (100, 200), opacity=[(0, 0), (0.5, 0), (0.5, 1)], extinction=0.5
    )
    screen = matplotlib.colormaps["viridis"](np.array([0, 1.0]))[:, :3]
    np.testing.assert_allclose(to_srgb(function([100, 200])[:, :3]), screen, atol=1e-6)
    assert function([149.9, 150.1])[:, 3].tolist() == [0, 1]
    assert (function.colour, function.extinction, function.name) == ("emission", 0.5, "viridis")
    np.testing.assert_allclose(from_srgb(to_srgb(np.linspace(0, 1, 50))), np.linspace(0, 1, 50))


# Files


@pytest.mark.parametrize("of_gradients", [False, True])
def test_json_comes_back(tmp_path, of_gradients):
    function = RAMP.over_gradients([(0, 0), (3, 0.7)]) if of_gradients else RAMP
    function.save(tmp_path / "a.json")
    again = TF.load(tmp_path / "a.json")
    for field in ("values", "rgba", "gradients"):
        np.testing.assert_array_equal(getattr(again, field), getattr(function, field))
    for field in ("extinction", "colour", "value_unit", "length_unit", "name"):
        assert getattr(again, field) == getattr(function, field)


@pytest.mark.parametrize("name", list_presets())
def test_presets(name):
    """Named after their files, with units, and something to see; those of CT in HU."""
    preset = TF.load(name)
    assert preset.name == name
    assert preset.length_unit == "mm"
    assert preset.value_unit == ("HU" if name.startswith("ct") else "share of the window")
    assert preset(np.linspace(*preset.range, 50), preset.gradient_range and 0.2)[:, 3].max() > 0.25
    air = TF.load(name)(-1000 if name.startswith("ct") else 0, 1e9)
    assert air[3] == 0


def test_presets_of_slicer(tmp_path):
    (tmp_path / "presets.xml").write_text(SLICER)
    ct = TF.load(f"{tmp_path}/presets.xml#CT-A")
    assert (ct.name, ct.value_unit, ct.length_unit, ct.colour) == ("CT-A", "HU", "mm", "emission")
    sigma = ct.extinction * ct(np.array([50, 99.999, 100.001, 200]), 1e9)[:, 3]
    exact = -np.log(1 - np.array([0.25, 0.5, 0.9, 0.95]))
    np.testing.assert_allclose(sigma, exact, atol=1e-3 * ct.extinction)
    assert ct(200, 25)[3] * ct.extinction == pytest.approx(-np.log(0.05) / 2, rel=0.01)
    np.testing.assert_allclose(to_srgb(ct(150, 0)[:3]), [0.5, 0.25, 0], atol=0.02)
    plain = TF.load(f"{tmp_path}/presets.xml#B")
    assert (plain.gradients, plain.value_unit) == (None, "")
    assert plain.extinction == pytest.approx(np.log(2))
    for part, sentence in {
        "": r"has 2 presets; name one: .*presets\.xml#CT-A",
        "#CT-B": "no preset 'CT-B'; did you mean CT-A",
    }.items():
        with pytest.raises(BrdfkitError, match=sentence):
            TF.load(f"{tmp_path}/presets.xml{part}")


GOOD = {"kind": "brdfkit transfer function", "points": [[0, 0, 0, 0, 0], [1, 1, 1, 1, 1]]}


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("{", "is no valid JSON"),
        pytest.param("[" * 200_000, "is no valid JSON", id="deep"),
        ("[]", "is no transfer function"),
        (json.dumps({**GOOD, "colr": "albedo"}), "no field 'colr'; did you mean colour"),
        (json.dumps({**GOOD, "points": [[1, 0, 0, 0]]}), "rows of five numbers"),
        (json.dumps({**GOOD, "points": GOOD["points"][::-1]}), r"out of order: point 2 \(0\) lies"),
        (json.dumps({**GOOD, "extinction": -1}), "extinction = -1 should be a number above 0"),
        (json.dumps({**GOOD, "colour": "opacity"}), "no meaning of RGB 'opacity'"),
        (json.dumps({**GOOD, "gradient_ramp": [[1, 0], [0, 1]]}), "gradients are out of order"),
        (json.dumps({**GOOD, "gradient_ramp": [[1, 0], [0]]}), "a ramp needs points"),
        (json.dumps({**GOOD, "gradient_ramp": {"a": 1}}), "a ramp needs points"),
        (json.dumps({**GOOD, "gradient_ramp": [[0, 0], [10**400, 1]]}), "a ramp needs points"),
        (json.dumps({**GOOD, "points": [[10**400] * 5] * 2}), "rows of five numbers"),
        (json.dumps({**GOOD, "extinction": 10**400}), "should be a number above 0"),
        (json.dumps({"kind": GOOD["kind"]}), "values should be two or more numbers"),
    ],
)
def test_bad_json(tmp_path, text, sentence):
    (tmp_path / "a.json").write_text(text)
    with pytest.raises(BrdfkitError, match=sentence) as told:
        TF.load(tmp_path / "a.json")
    assert "a.json: " in str(told.value)


@pytest.mark.parametrize(
    ("xml", "sentence"),
    [
        ("<MRML", "is no XML"),
        ("<MRML/>", "has no <VolumeProperty>"),
        (SLICER.replace("8 0 0 100", "9 0 0 100"), "CT-A: scalarOpacity should be the count"),
        (SLICER.replace("100 0.9", "90 0.9"), "values of scalarOpacity are out of order"),
        (SLICER.replace("300 1 0.5 0", "300 1 x 0"), "CT-A: colorTransfer should be the count"),
    ],
)
def test_bad_presets_of_slicer(tmp_path, xml, sentence):
    (tmp_path / "a.xml").write_text(xml)
    with pytest.raises(BrdfkitError, match=sentence):
        TF.load(f"{tmp_path}/a.xml#CT-A")


@pytest.mark.parametrize(
    ("make", "sentence"),
    [
        (
            lambda: TF([1, 0], np.zeros((2, 4))),
            r"values are out of order: point 2 \(0\) lies before",
        ),
        (lambda: TF([0, 0], np.zeros((2, 4))), "are all 0; the last should be above the first"),
        (lambda: TF([0], np.zeros((1, 4))), "should be two or more numbers"),
        (lambda: TF([0, np.nan], np.zeros((2, 4))), "should be two or more numbers"),
        (lambda: TF([0, 1], np.zeros((2, 3))), r"shape \(2, 3\); it should be \(2, 4\)"),
        (lambda: TF([0, 1], np.full((2, 4), 1.5)), "as albedo the numbers should be 0 to 1"),
        (lambda: TF([0, 1], np.full((2, 4), 1.5), colour="emission"), "A at most 1"),
        (lambda: TF([0, 1], np.zeros((2, 4)), extinction=0), "should be a number above 0"),
        (lambda: TF.from_opacity([0, 1], np.zeros((2, 4)), unit_distance=0), "unit_distance = 0"),
        (lambda: TF.from_colormap("vridis"), "no colour map 'vridis'; did you mean viridis"),
        (lambda: TF.load("ct_bon"), "did you mean ct_bone"),
        (lambda: RAMP.save("a.txt"), r"are written as \.json"),
        (lambda: RAMP.scaled_to(1, 1), "does not rise"),
        (lambda: RAMP.over_gradients([1, 2]), "a ramp needs points"),
    ],
)
def test_what_is_no_transfer_function(make, sentence):
    with pytest.raises(BrdfkitError, match=sentence):
        make()
