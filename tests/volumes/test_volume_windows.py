"""The window of a volume's values by its histogram, and functions of boundaries."""

import numpy as np
import pytest

from brdfkit import BrdfkitError
from brdfkit.core.colours import to_srgb
from brdfkit.rendering.volumes import defaults
from brdfkit.volumes import TransferFunction, Volume
from brdfkit.volumes.summary.summary import summarise
from brdfkit.volumes.transfer.windows import (
    find_upper_percentile,
    find_window,
    scale_transfer_to_values,
)

pytestmark = pytest.mark.quick
RNG = np.random.default_rng(29)
Z, Y, X = np.mgrid[-1:1:40j, -1:1:40j, -1:1:40j]
BALL = np.sqrt(X**2 + Y**2 + Z**2) < 0.7
TISSUE = RNG.normal(500, 40, X.shape)
NOISE = np.abs(RNG.normal(0, 15, X.shape))


def with_outliers(values):
    found = values.copy()
    found.flat[[5, 50_000]] = 1e6, -1e6
    return found


# values; from where to where the low end of the window should be, and the high one
WINDOWS = {
    "in noisy air": (np.where(BALL, TISSUE, NOISE), (45, 430), (560, 640)),
    "with outliers": (with_outliers(np.where(BALL, TISSUE, NOISE)), (45, 430), (560, 640)),
    "masked": (np.where(BALL, TISSUE, 0), (150, 430), (560, 640)),
    "in HU": (np.where(BALL, TISSUE, NOISE - 1000), (-940, 430), (560, 640)),
    "without air": (TISSUE, (350, 430), (560, 640)),
    "of one matter": (np.where(BALL, 7.0, 0), (3, 6.9), (7, 7)),
    "nearly empty": (np.where(np.arange(64_000) < 30, 9.0, 0).reshape(40, 40, 40), (4, 8), (9, 9)),
    "constant": (np.full((4, 4, 4), -3.0), (-3, -3), (0, 0)),
    "one voxel": (np.full((1, 1, 1), 2.0), (0, 0), (2, 2)),
}


@pytest.mark.parametrize("name", WINDOWS)
def test_windows_leave_air_and_outliers_out(name):
    values, low, high = WINDOWS[name]
    found = find_window(values)
    assert low[0] <= found[0] <= low[1]
    assert high[0] <= found[1] <= high[1]
    scaled = find_window(values * 1e-6)  # data of any size
    np.testing.assert_allclose(scaled, np.array(found) * 1e-6, rtol=1e-3)


@pytest.mark.parametrize("name", WINDOWS)
@pytest.mark.parametrize("percent", [0, 50, 99.9, 100])
def test_upper_percentiles_are_those_of_all_values(name, percent):
    values = WINDOWS[name][0]
    expected = np.percentile(values, percent)
    np.testing.assert_allclose(find_upper_percentile(values, percent), expected, rtol=1e-10)


@pytest.mark.parametrize("name", [n for n in WINDOWS if n != "constant"])
@pytest.mark.parametrize("axes", ["", "RAS"])
@pytest.mark.parametrize("renderer", ["single_scattering", "emission_absorption"])
def test_by_default_matter_shows_and_air_does_not(name, axes, renderer):
    if name == "in HU" and axes:
        pytest.skip("values in HU have presets")
    volume = Volume(WINDOWS[name][0], axes=axes)
    transfer = defaults.choose_transfer_function(volume, renderer)
    depth = transfer.extinction * transfer(volume.values)[..., 3]  # of a voxel
    if name not in ("without air", "nearly empty", "one voxel"):
        assert np.median(depth[BALL]) > 0.01
        assert np.percentile(depth[~BALL], 95) < 1e-3
    assert depth.max() > 0.01


def test_largest_values_use_all_greys():
    """The largest values of a ball of tissue differ by a tenth, its greys by half of the scale."""
    ball = np.where(BALL, 500 + 50 * X, 0)
    function = defaults.choose_transfer_function(Volume(ball, axes="RAS"), "maximum_intensity")
    largest = ball.max(axis=0)
    greys = to_srgb(function(largest[largest > 0])[:, 0])
    assert np.ptp(np.percentile(greys, [10, 90])) > 0.4
    assert (np.diff(function(np.linspace(0, 550, 99))[:, 0]) > -1e-9).all()


@pytest.mark.parametrize(("densest", "name"), [(1000, "ct_bone"), (80, "ct_skin")])
def test_scans_without_bone_show_their_skin(densest, name):
    hu = np.where(BALL, 40.0, -1000)
    hu[18:22, 18:22, 18:24] = densest
    hu[0, 0, 0] = 250  # metal beside the body
    assert (
        defaults.choose_transfer_function(Volume(hu, axes="RAS"), "single_scattering").name == name
    )


def test_the_level_is_not_of_outliers():
    clean = np.where(BALL, TISSUE, NOISE)
    level = defaults.choose_surface_level(Volume(with_outliers(clean)))
    assert 45 < level < 430


@pytest.mark.parametrize("voxel", [(9, 9, 9), (9, 9, 10)])  # the first is not sampled
def test_the_level_of_a_volume_that_is_empty_but_for_one_voxel(monkeypatch, voxel):
    """It was below all values, after a warning of NumPy's."""
    monkeypatch.setattr(defaults.windows, "SAMPLED_VOXELS", 4000)
    values = np.zeros((20, 20, 20))
    values[voxel] = 5
    assert 0 < defaults.choose_surface_level(Volume(values)) < 5
    assert 0 < defaults.choose_surface_level(Volume(values[9:10, 9:10, 9:11])) < 5


# Boundaries


def test_a_boundary_is_a_shell_of_one_thickness():
    """Of a ramp of any slope, A falls from 1 on the surface to 0 at the thickness."""
    rows = [[100, 60, 0.2, 0.4, 0.6, 1]]
    function = TransferFunction.from_boundaries(rows, 2.0, values=(-100, 300))
    x = np.linspace(-3, 3, 13)
    for slope in (18.75, 37.5, 56.25):  # on the grid
        a = function(100 + slope * x, slope)[:, 3]
        np.testing.assert_allclose(a, np.clip(1 - np.abs(x) / 2, 0, 1), atol=0.04)
    np.testing.assert_allclose(function(100, 37.5)[:3], [0.2, 0.4, 0.6], atol=1e-3)
    assert function(400, 56.25)[3] == 0  # beyond the ends
    assert function(100, 80)[3] == 0  # steeper: another boundary through the same value
    assert (function(np.linspace(-100, 300, 99), 0)[:, 3] == 0).all()  # even matter


def test_boundaries_are_no_product():
    rgba = TransferFunction.load("mri_edges").rgba
    singular = np.linalg.svd(rgba[..., 3], compute_uv=False)
    assert singular[1] > 0.2 * singular[0]


@pytest.mark.parametrize(
    ("rows", "thickness", "message"),
    [
        ([[1, 2, 3]], 1, "six numbers"),
        ([[1, 0, 0, 0, 0, 1]], 1, "above 0"),
        ([[1, 1, 0, 0, 0, 2]], 1, "0 to 1"),
        ([[1, 1, 0, 0, 0, 1]], 0, "thickness"),
        ("x", 1, "six numbers"),
    ],
)
def test_what_is_no_boundary_is_said(rows, thickness, message):
    with pytest.raises(BrdfkitError, match=message):
        TransferFunction.from_boundaries(rows, thickness, values=(0, 1))


def test_files_of_boundaries(tmp_path):
    path = tmp_path / "edges.json"
    rows = [[0.5, 0.1, 1, 1, 1, 1]]
    path.write_text(
        f'{{"kind": "brdfkit transfer function", "boundaries": {rows}, "thickness": 1, '
        '"range": [0, 1], "value_unit": "share of the window"}'
    )
    found = TransferFunction.load(path)
    np.testing.assert_allclose(
        found.rgba, TransferFunction.from_boundaries(rows, 1, values=(0, 1)).rgba
    )
    assert (found.value_unit, found.extinction) == ("share of the window", 1)
    path.write_text('{"kind": "brdfkit transfer function", "boundaries": [[1, 2]]}')
    with pytest.raises(BrdfkitError, match=r"edges\.json: thickness = None"):
        TransferFunction.load(path)


# Drawn over the histograms


@pytest.mark.parametrize("name", ["mri_edges", "mri_head", "ct_bone"])
def test_functions_are_drawn_over_histograms(name):
    volume = Volume(np.where(BALL, TISSUE, NOISE), axes="RAS", unit="µm")
    preset = TransferFunction.load(name)
    figure = summarise(volume).picture(preset)
    histogram = next(a for a in figure.axes if a.get_ylabel().startswith("gradient"))
    veil = histogram.images[-1].get_array()
    low, high, _, steepest = histogram.images[-1].get_extent()
    whole = scale_transfer_to_values(preset, volume.values).per("µm")
    at = low + (high - low) * 300 / 399, steepest * 120 / 399
    a = whole(*(at if whole.gradients is not None else at[:1]))[3]
    assert veil[120, 300, 3] == pytest.approx(0.85 * a, abs=1e-6)
    curves = [line for axes in figure.axes if axes.get_ylabel() == "A" for line in axes.lines]
    assert len(curves) == (whole.gradients is None)
