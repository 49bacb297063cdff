"""Transfer functions in Mitsuba: what is looked up, its bounds, Mitsuba's own media, bad input."""

from dataclasses import replace

import drjit as dr
import numpy as np
import pytest

from brdfkit.volumes import TransferFunction, Volume
from brdfkit.volumes.transfer.block_bounds import bound_piecewise_linear, find_block_ranges
from brdfkit.volumes.transfer.lookup import TransferLookup

RNG = np.random.default_rng(6)
HILLS = TransferFunction(
    [-20, 5, 5, 40, 100],
    [
        [0.9, 0.3, 0.4, 0],
        [0.8, 0.7, 0.6, 0.1],
        [0.9, 0.5, 0.6, 0.9],
        [0.2, 0.8, 0.9, 0.3],
        [0.5] * 4,
    ],
    extinction=4,
)


@pytest.fixture
def mi(llvm_variant):
    return llvm_variant


def grid(mi, values, **settings):
    """A gridvolume of values (nz, ny, nx), or (nz, ny, nx, channels)."""
    values = np.asarray(values, np.float32)
    values = values.reshape(*values.shape[:3], -1)
    return {"type": "gridvolume", "grid": mi.VolumeGrid(values), "raw": True, **settings}


def volume(mi, values, function, grid_settings=None, **settings):
    values = grid(mi, values, **(grid_settings or {}))
    entries = {"values": values, "transfer": function.to_json(), **settings}
    return {"type": "transfer_function", **entries}


def looked_up(mi, loaded, points):
    """RGBA (n, 4) of a volume at `points` (n, 3)."""
    it = dr.zeros(mi.Interaction3f, len(points))
    it.p = mi.Point3f(np.ascontiguousarray(points.T, np.float32))
    sigma, rgb = loaded.eval_extinction_and_colour(it)
    return np.vstack([rgb, np.array(sigma) / loaded.function.extinction]).T


# What is looked up


def test_what_is_looked_up_is_the_function_of_the_value(mi):
    """Of a value, of a value and a gradient magnitude, and within an oblique box, in NumPy."""
    values = RNG.uniform(-30, 110, (4, 5, 6))
    cube = mi.ScalarTransform4f().translate([1, 2, 3]).rotate([0.6, 0.8, 0], 30).scale([2, 3, 4])
    to_indices = np.diag([6, 5, 4, 1.0])
    to_indices[:3, 3] = -0.5
    known = Volume(values, np.array(cube.matrix) @ np.linalg.inv(to_indices))
    local = RNG.uniform(0.01, 0.99, (200, 3))
    points = local @ np.array(cube.matrix)[:3, :3].T + [1, 2, 3]
    at = known(points)
    smooth = np.abs(at - 5) > 0.2  # the step is as wide as that of a table

    given = volume(mi, values, HILLS, {"to_world": cube})
    found = looked_up(mi, mi.load_dict(given), points)
    np.testing.assert_allclose(found[smooth], HILLS(at)[smooth], atol=2e-4)

    both = HILLS.over_gradients([[0, 0], [10, 0.2], [40, 1]])
    magnitudes = known.gradient_magnitude
    given = volume(mi, np.stack([values, magnitudes], -1), both, {"to_world": cube})
    found = looked_up(mi, mi.load_dict(given), points)
    expected = both(at, Volume(magnitudes, known.to_world)(points))
    np.testing.assert_allclose(found[smooth], expected[smooth], atol=2e-3)


@pytest.mark.quick
def test_labels_have_their_own_colours(mi):
    labels = np.arange(30).reshape(2, 3, 5)
    rgba = RNG.random((30, 4))
    given = volume(mi, labels, TransferFunction(range(30), rgba), {"filter_type": "nearest"})
    inside = RNG.uniform(0, 1, (100, 3))
    x, y, z = (inside * [5, 3, 2]).astype(int).T
    found = looked_up(mi, mi.load_dict(given), inside)
    np.testing.assert_allclose(found, rgba[labels[z, y, x]], atol=1e-5)


def test_shares_of_the_range_are_scaled(mi):
    """A preset of MRI, whose values have no unit."""
    loaded = mi.load_dict(
        {**volume(mi, RNG.random((4, 4, 4)) * 500 + 7, HILLS), "transfer": "mri_head"}
    )
    low, high = loaded.function.range
    assert 7 < low < 80 < 400 < high < 507


@pytest.mark.parametrize("variant", ["llvm_ad_mono", "llvm_ad_spectral"])
def test_colours_in_other_variants(mi, variant, request):
    """An albedo, and the same as an emission, which has the spectrum of D65."""
    request.addfinalizer(lambda: mi.set_variant("llvm_ad_rgb"))
    mi.set_variant(variant)
    grey = TransferFunction([0, 1], [[0.4, 0.4, 0.4, 1]] * 2)
    glow = TransferFunction([0, 1], [[0.4, 0.4, 0.4, 1]] * 2, colour="emission")
    it = dr.zeros(mi.Interaction3f, 1)
    if mi.is_spectral:
        it.wavelengths = [450, 520, 590, 650]
    values = np.ones((2, 2, 2))
    albedo, light = (
        np.ravel(mi.load_dict(volume(mi, values, f, output="colour")).eval(it))
        for f in (grey, glow)
    )
    np.testing.assert_allclose(albedo, 0.4, atol=2e-3)
    assert light == pytest.approx(0.4 if variant == "llvm_ad_mono" else light, abs=2e-3)
    assert (light[0] > 1.2 * light[-1]) == mi.is_spectral  # D65 is bluish
    sigma = mi.load_dict(volume(mi, values, grey)).eval(it)
    np.testing.assert_allclose(np.ravel(sigma), 1, atol=1e-5)


# The dictionaries of a volume


def test_a_volume_in_a_scene_is_where_it_is(mi):
    """Oblique, of µm, and with a function of gradient magnitudes per mm; labels by the nearest."""
    values = RNG.uniform(-30, 110, (4, 5, 6))
    turned = np.array(mi.ScalarTransform4f().translate([1, 2, 3]).rotate([0.6, 0.8, 0], 30).matrix)
    known = Volume(values, turned @ np.diag([20, 30, 40, 1.0]), unit="µm")
    inside = np.diag([*known.size, 1.0])[:3, :3] @ RNG.uniform(0.01, 0.99, (3, 200)) - 0.5
    points = (known.to_world[:3, :3] @ inside + known.to_world[:3, 3:]).T
    it = dr.zeros(mi.Interaction3f, len(points))
    it.p = mi.Point3f(np.ascontiguousarray(points.T, np.float32))
    found = mi.load_dict(known.scene_dict()).eval_1(it)
    np.testing.assert_allclose(found, known(points), atol=2e-2)

    whole = Volume(np.rint(values).astype(int), known.to_world, labels=True)
    found = mi.load_dict(whole.scene_dict()).eval_1(it)
    assert (np.array(found) == whole(points)).mean() > 0.99  # but at edges of voxels, by rounding

    per_mm = replace(HILLS, length_unit="mm").over_gradients([[0, 0], [1000, 0.2], [4000, 1]])
    seen = mi.load_dict(known.scene_dict(per_mm))
    assert seen.function.extinction == pytest.approx(4e-3)
    assert seen.function.gradient_range == (0, 4)
    magnitudes = Volume(known.gradient_magnitude, known.to_world)(points)
    expected = per_mm(known(points), 1000 * magnitudes)
    smooth = np.abs(known(points) - 5) > 0.5
    np.testing.assert_allclose(looked_up(mi, seen, points)[smooth], expected[smooth], atol=5e-3)


# Bounds


@pytest.mark.quick
def test_the_largest_value_between_two_places():
    """Against the function at very many places; its corners are among them."""
    rows = RNG.random(37)
    low, high = np.sort(RNG.uniform(-3, 40, (2, 300)), axis=0)
    found = bound_piecewise_linear(rows, low, high)
    for a, b, largest in zip(low, high, found, strict=True):
        places = np.unique(np.clip([*np.linspace(a, b, 50), *range(37)], a, b))
        truth = np.interp(places, np.arange(37), rows).max()
        assert truth <= largest <= truth + 0.002


@pytest.mark.parametrize("filter_type", ["trilinear", "nearest"])
def test_the_bounds_of_blocks_hold(mi, filter_type):
    """At random points, of which many come near; after the table was changed, too."""
    values = np.cumsum(RNG.normal(0, 20, (17, 16, 25)), axis=0)
    low, _ = find_block_ranges(values)
    assert low.shape == (2, 2, 3)
    loaded = mi.load_dict(volume(mi, values, HILLS, {"filter_type": filter_type}))
    points = RNG.random((20_000, 3))
    blocks = (points * [3, 2, 2]).astype(int)[:, ::-1]
    parameters = mi.traverse(loaded)
    for scale in (1, 0.5):
        parameters["table"] = mi.TensorXf(np.array(parameters["table"]) * scale)
        parameters.update()
        sigma = 4 * looked_up(mi, loaded, points)[:, 3]
        bounds = loaded.majorants[tuple(blocks.T)]
        assert (sigma <= bounds).all()
        largest = np.zeros((2, 2, 3))
        np.maximum.at(largest, tuple(blocks.T), sigma)
        np.testing.assert_allclose(largest, loaded.majorants, rtol=0.1)
        assert loaded.max() == loaded.majorants.max()


# Mitsuba's own media


def test_mitsuba_renders_a_transfer_function(mi):
    """`volpath` in a `heterogeneous` medium: light from behind, by quadrature in NumPy, and glow.

    The mean of as many rays as there are is within 4 standard errors.
    """
    values = np.linspace(-20, 100, 8).reshape(8, 1, 1)
    medium = {
        "type": "heterogeneous",
        "sigma_t": volume(mi, values, HILLS),
        "albedo": 0.0,
    }
    t = mi.ScalarTransform4f
    camera = t().look_at([0.5, 0.5, 3], [0.5, 0.5, 0], [0, 1, 0]).scale(0.3)
    film = {"type": "hdrfilm", "width": 8, "height": 8, "rfilter": {"type": "box"}}
    cube = {"type": "cube", "to_world": t().translate(0.5).scale(0.5), "bsdf": {"type": "null"}}
    scene = mi.load_dict(
        {
            "type": "scene",
            "integrator": {"type": "volpath"},
            "sensor": {"type": "orthographic", "to_world": camera, "film": film},
            "cube": {**cube, "interior": medium},
            "light": {"type": "constant"},
        }
    )
    z = (np.arange(100_000) + 0.5) / 100_000
    sigma = 4 * HILLS(np.interp(8 * z - 0.5, range(8), values.ravel()))[:, 3]
    transmittance = np.exp(-sigma.mean())
    rays = 64 * 1024
    found = np.array(mi.render(scene, spp=1024, seed=1)).mean()
    error = np.sqrt(transmittance * (1 - transmittance) / rays)
    assert abs(found - transmittance) < 4 * error


# Bad input


@pytest.mark.quick
@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"transfer": "ct_bon"}, "no transfer function 'ct_bon'; did you mean ct_bone"),
        ({"transfer": "{"}, "transfer_function: transfer: is no valid JSON"),
        ({"transfer": '{"kind": 1}'}, 'transfer_function: transfer: .*its "kind" should be'),
        ({"transfer": "mri_edges"}, "mri_edges is one of values and gradient magnitudes, and the"),
        ({"output": "opacity"}, "output = opacity should be one of extinction, colour"),
        ({"values": "head.nii"}, "values = head.nii should be a volume, such as a gridvolume"),
    ],
)
def test_what_cannot_be_looked_up_is_said(mi, given, said):
    with pytest.raises(RuntimeError, match=said):
        mi.load_dict({"type": "transfer_function", **given})


@pytest.mark.quick
def test_values_that_are_not_finite_are_refused(mi):
    with pytest.raises(RuntimeError, match="should be a volume of finite values"):
        mi.load_dict(volume(mi, np.full((2, 2, 2), np.nan), HILLS))


def test_a_narrow_peak_is_seen_and_one_that_is_too_narrow_is_told(mi):
    """A table of 4096 rows would miss both."""
    rgba = [[1, 1, 1, 0], [1, 1, 1, 0], [1, 0, 0, 1], [1, 1, 1, 0], [1, 1, 1, 0]]
    peak = TransferFunction([0, 0.5, 0.50005, 0.5001, 1], rgba)
    _, a = TransferLookup(peak)([mi.Float(0.50005)])
    assert a[0] == pytest.approx(1, abs=0.01)
    with pytest.warns(UserWarning, match="1e-06 of its range apart"):
        TransferLookup(replace(peak, values=np.array([0, 0.5, 0.500001, 0.500002, 1])))
