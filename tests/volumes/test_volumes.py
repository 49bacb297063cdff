"""Volumes: where their voxels lie, what is between them, made ones, and what `info` tells."""

import json

import numpy as np
import pytest
import small_volumes as small
from click.testing import CliRunner
from scipy.spatial.transform import Rotation
from small_volumes import TO_WORLD, values

import brdfkit as bk
from brdfkit.cli import main
from brdfkit.core.errors import BrdfkitError
from brdfkit.volumes import made
from brdfkit.volumes.made import marschner_lobb, shepp_logan, slab, smoke, sphere
from brdfkit.volumes.orientation import find_nearest_axes
from brdfkit.volumes.summary.summary import summarise

OBLIQUE = bk.volumes.Volume(values(np.float32) ** 2, TO_WORLD, "oblique", unit="mm")
SHEARED = TO_WORLD @ np.array([[1, 0.3, 0, 0], [0, 1, 0.2, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]])


def world(volume, indices):
    """Points (n, 3) of the world of places (n, 3) in the grid."""
    return np.atleast_2d(indices) @ volume.to_world[:3, :3].T + volume.to_world[:3, 3]


# Where voxels lie


@pytest.mark.quick
def test_slices_lie_where_the_box_does():
    """Their axes show the world's coordinates, also where an axis of the grid runs downwards."""
    to_world = np.diag([-1.0, 1.0, 2.0, 1.0])
    to_world[:3, 3] = 3.0, -98.5, -7.0
    found = summarise(bk.volumes.Volume(np.arange(24.0).reshape(2, 3, 4), to_world))
    box = list(zip(found.low, found.high, strict=True))
    axes = found.picture().axes[:3]
    for one, (across, up) in zip(axes, ((0, 1), (0, 2), (1, 2)), strict=True):
        for limits, axis in ((one.get_xlim(), across), (one.get_ylim(), up)):
            assert sorted(limits) == pytest.approx(box[axis])


@pytest.mark.quick
def test_slices_of_a_patient_are_upright():
    """The patient's right, or front, is at the left, however the voxels are stored."""
    to_world = np.diag([-1.0, -1.0, 2.0, 1.0])  # an axial series of DICOM
    found = summarise(bk.volumes.Volume(np.arange(24.0).reshape(2, 3, 4), to_world, axes="RAS"))
    shown = [
        (one.get_title().split(":")[0], one.get_xlabel()[4:], one.get_ylabel()[4:])
        for one in found.picture().axes[:3]
    ]
    axial, coronal, sagittal = (one.images[0].get_array() for one in found.picture().axes[:3])
    left, back, head = "left", "back", "head"
    expected = [("Axial", left, "front"), ("Coronal", left, head), ("Sagittal", back, head)]
    assert shown == expected
    values = np.arange(24.0).reshape(2, 3, 4)  # of which x points to the left, y to the back
    np.testing.assert_array_equal(axial, values[1])
    np.testing.assert_array_equal(coronal, values[::-1, 1])
    np.testing.assert_array_equal(sagittal, values[::-1, :, 2])


@pytest.mark.quick
def test_each_axis_of_a_turned_grid_has_its_own_axis_of_the_world():
    """Also where two of the grid's axes are nearest to the same one."""
    turns = [
        *Rotation.random(200, rng=0).as_matrix(),
        Rotation.from_euler("z", 45, True).as_matrix(),
    ]
    shared = 0
    for turn in turns:
        to_world = np.eye(4)
        to_world[:3, :3] = turn * (1.0, 2.0, 0.5)
        nearest, signs = find_nearest_axes(to_world)
        assert sorted(nearest) == [0, 1, 2]
        assert (turn[nearest, range(3)] * signs > 0).all()
        largest = np.abs(turn).argmax(axis=0).tolist()
        if len(set(largest)) == 3:
            assert list(nearest) == largest
        shared += len(set(largest)) < 3
    assert shared > 0


def test_spacing_box_and_cube():
    np.testing.assert_allclose(OBLIQUE.spacing, small.SPACING)
    assert OBLIQUE.size == (6, 5, 4)
    corners = np.array(np.meshgrid([-0.5, 5.5], [-0.5, 4.5], [-0.5, 3.5])).reshape(3, -1).T
    points = world(OBLIQUE, corners)
    np.testing.assert_allclose(OBLIQUE.bounds, [points.min(axis=0), points.max(axis=0)])
    cube = OBLIQUE.cube_to_world
    np.testing.assert_allclose(cube @ [0, 0, 0, 1], [*world(OBLIQUE, [-0.5, -0.5, -0.5])[0], 1])
    np.testing.assert_allclose(cube @ [1, 1, 1, 1], [*world(OBLIQUE, [5.5, 4.5, 3.5])[0], 1])
    assert str(OBLIQUE) == "oblique: 6×5×4 voxels of 0.5×0.75×2 mm, float32, 0 to 4761"


@pytest.mark.quick
def test_resizing_keeps_means_places_and_labels():
    even = bk.volumes.Volume(values(np.float32, (4, 6, 8)), TO_WORLD)
    small_one = even.resized(2)
    assert small_one.values.mean() == pytest.approx(even.values.mean(), rel=1e-6)
    np.testing.assert_allclose(small_one.bounds, even.bounds)
    blocks = even.values.reshape(2, 2, 3, 2, 4, 2).mean(axis=(1, 3, 5))
    np.testing.assert_allclose(small_one.values, blocks)
    np.testing.assert_allclose(
        OBLIQUE.resized(4).values[0, -1, -1], OBLIQUE.values[:, 4:, 4:].mean()
    )
    labels = bk.volumes.Volume(values(np.uint8), labels=True).resized(3)
    assert labels.values.dtype == np.uint8
    assert labels.values[0, 0, 0] == values(np.uint8)[1, 1, 1]
    assert labels.size == (2, 2, 2)
    ends = labels(world(labels, [[1, 1, 1]]))
    assert ends == values(np.uint8)[-1, 4, 4]


@pytest.mark.quick
@pytest.mark.parametrize(
    ("given", "how", "sentence"),
    [
        (np.full((2, 2, 2), np.nan), {}, "8 of 8 voxels are not finite"),
        (np.zeros((2, 2, 2)), {}, "all voxels are 0"),
        (np.ones((0, 2, 2)), {}, r"have the shape \(0, 2, 2\)"),
        (np.ones((2, 2)), {}, r"have the shape \(2, 2\)"),
        (np.ones((2, 2, 2), complex), {}, "complex128, where real numbers"),
        (np.full((2, 2, 2), 0.5), {"labels": True}, "not whole numbers, so they cannot be labels"),
        (np.ones((2, 2, 2)), {"to_world": np.zeros((4, 4))}, "no invertible 4×4 matrix"),
        (np.ones((2, 2, 2)), {"to_world": np.diag([1e200, 1, 1, 1])}, "no invertible 4×4 matrix"),
        (np.ones((2, 2, 2)), {"to_world": np.diag([1e-200, 1, 1, 1])}, "no invertible 4×4 matrix"),
        (np.full((2, 2, 2), 3e9, np.float32), {"labels": True}, "not whole numbers"),
        (np.ones((2, 2, 2)), {"to_world": np.eye(3)}, "no invertible 4×4 matrix"),
        (np.ones((2, 2, 2)), {"to_world": np.diag([1, 1, 1, 2])}, "no invertible 4×4 matrix"),
        (np.full((2, 2, 2), 1e60), {}, "8 of 8 voxels are not finite"),
        (np.full((2, 2, 2), 1e-60), {}, "all voxels are 0"),
        (np.reshape([-3e38, 3e38], (1, 1, 2)), {}, "too large or too close together"),
        (np.reshape([1e-42, 2e-42], (1, 1, 2)), {}, "too large or too close together"),
    ],
)
def test_what_is_no_volume(given, how, sentence):
    with pytest.raises(BrdfkitError, match=sentence):
        bk.volumes.Volume(given, **how)


@pytest.mark.quick
def test_types_of_values():
    for given, kept in (
        (float, np.float32),
        (np.float16, np.float32),
        (bool, np.uint8),
        (">i4", int),
    ):
        found = bk.volumes.Volume(np.ones((2, 2, 2), given)).values
        assert found.dtype.isnative
        assert np.issubdtype(found.dtype, kept if kept is not int else np.int32)
    assert bk.volumes.Volume(np.full((2, 2, 2), 3.0), labels=True).values.dtype == np.int32


# Between voxels


@pytest.mark.quick
def test_trilinear_against_scipy_and_nearest():
    from scipy.ndimage import map_coordinates

    places = np.random.default_rng(1).uniform(-0.5, [5.5, 4.5, 3.5], (200, 3))
    found = OBLIQUE(world(OBLIQUE, places))
    expected = map_coordinates(
        OBLIQUE.values.astype(float), places.T[::-1], order=1, mode="nearest"
    )
    np.testing.assert_allclose(found, expected, rtol=1e-9)
    labels = bk.volumes.Volume(values(np.uint8), TO_WORLD, labels=True)
    assert set(labels(world(labels, places))) <= set(values(np.uint8).ravel())
    assert (OBLIQUE(world(OBLIQUE, [[-0.51, 0, 0], [0, 0, 3.51]])) == 0).all()


@pytest.mark.quick
@pytest.mark.parametrize("to_world", [TO_WORLD, SHEARED])
def test_gradients_of_a_linear_field_are_exact(to_world):
    slope = np.array([2.0, -3.0, 0.5])
    grid = np.stack(np.meshgrid(*(np.arange(n) for n in (6, 5, 4)), indexing="ij"), axis=-1)
    points = grid.reshape(-1, 3) @ to_world[:3, :3].T + to_world[:3, 3]
    linear = (points @ slope).reshape(6, 5, 4).T
    volume = bk.volumes.Volume(linear, to_world)
    np.testing.assert_allclose(volume.gradient_magnitude, np.linalg.norm(slope), rtol=1e-4)
    inside = world(volume, np.random.default_rng(2).uniform(1, [4, 3, 2], (20, 3)))
    for of_interpolant in (False, True):
        found = volume.gradient(inside, of_interpolant)
        np.testing.assert_allclose(found, np.broadcast_to(slope, (20, 3)), rtol=1e-4)


@pytest.mark.quick
def test_the_interpolants_derivative_is_that_of_its_values():
    """By differences within cells of random values, in an oblique frame."""
    rng = np.random.default_rng(3)
    volume = bk.volumes.Volume(rng.random((4, 5, 6)), TO_WORLD)
    places = np.floor(rng.uniform(0, [5, 4, 3], (30, 3))) + rng.uniform(0.1, 0.9, (30, 3))
    points, step = world(volume, places), 1e-4
    differences = [
        (volume(points + step * axis) - volume(points - step * axis)) / (2 * step)
        for axis in np.eye(3)
    ]
    found = volume.gradient(points, of_interpolant=True)
    np.testing.assert_allclose(found, np.stack(differences, axis=1), rtol=1e-6, atol=1e-7)


def gradient_of_marschner_lobb(x, y, z):
    """∇ρ (3, ...), at any points."""
    frequency, alpha = marschner_lobb.FREQUENCY, marschner_lobb.ALPHA
    r = np.maximum(np.hypot(x, y), 1e-12)  # on the axis the slope is 0
    phase = 2 * np.pi * frequency * np.cos(np.pi * r / 2)
    by_r = np.sin(phase) * np.pi**2 * frequency * np.sin(np.pi * r / 2)
    by_z = -np.pi / 2 * np.cos(np.pi * z / 2)
    slopes = np.stack([alpha * by_r * x / r, alpha * by_r * y / r, by_z + 0 * r])
    return slopes / (2 * (1 + alpha))


def test_gradients_converge_to_those_of_marschner_and_lobb():
    """Second order by differences, at the voxels; first order by the interpolant; closed form."""
    points = np.random.default_rng(4).uniform(-0.9, 0.9, (2000, 3))
    true = gradient_of_marschner_lobb(*points.T).T
    errors = {}
    for of_interpolant in (False, True):
        for n in (128, 256):
            volume = bk.volumes.load("marschner_lobb", size=(n, n, n // 4))
            off = volume.gradient(points, of_interpolant) - true
            errors[of_interpolant, n] = np.sqrt(np.square(off).mean())
    assert errors[False, 128] / errors[False, 256] == pytest.approx(4, abs=0.3)
    assert errors[True, 128] / errors[True, 256] == pytest.approx(2, abs=0.1)
    values_off = volume(points) - marschner_lobb.evaluate_signal(*points.T)
    assert np.abs(values_off).max() < 0.02
    # and the closed form itself, by differences
    step = 1e-6 * np.eye(3)
    for i in range(3):
        ahead, behind = (
            marschner_lobb.evaluate_signal(*(points + sign * step[i]).T) for sign in (1, -1)
        )
        np.testing.assert_allclose((ahead - behind) / 2e-6, true[:, i], atol=1e-7)


def test_gradient_magnitudes_of_large_values():
    """Their squares have no room in 32 bits."""
    values = np.random.default_rng(0).random((3, 4, 5), np.float32)
    large = bk.volumes.Volume(values * np.float32(2.0**90)).gradient_magnitude
    assert (large == bk.volumes.Volume(values).gradient_magnitude * np.float32(2.0**90)).all()


def test_gradient_magnitudes_of_many_layers_are_those_of_one_piece():
    """Taken by blocks of layers and rows, with what is beside them."""
    volume = bk.volumes.load("smoke", size=(20, 70, 40))
    x, y, z = volume.spacing
    slopes = np.gradient(volume.values, z, y, x)
    expected = np.sqrt(sum(np.square(slope) for slope in slopes))
    np.testing.assert_allclose(volume.gradient_magnitude, expected, rtol=1e-4, atol=1e-5)


# Made ones


@pytest.mark.quick
def test_made_volumes_fill_their_cube():
    assert set(made.list_volume_names()) == {
        "marschner_lobb",
        "shepp_logan",
        "slab",
        "smoke",
        "sphere",
    }
    for name in made.list_volume_names():
        volume = bk.volumes.load(name, size=(12, 16, 20))
        assert (volume.size, volume.name) == ((12, 16, 20), name)
        np.testing.assert_allclose(volume.bounds, [[-1, -1, -1], [1, 1, 1]], atol=1e-12)
        assert bk.volumes.load(name, size=16, downsample=2).size == (8, 8, 8)


@pytest.mark.quick
def test_made_volumes_have_their_closed_forms():
    def integral(volume):
        return volume.values.sum(dtype=float) * np.prod(volume.spacing)

    ball = sphere.make((40, 40, 40))
    assert integral(ball) == pytest.approx(np.pi / 6, rel=2e-3)
    column = ball.values.sum(axis=0)[20, 20] * ball.spacing[2]  # beside the axis
    assert column == pytest.approx(2 * np.sqrt(sphere.RADIUS**2 - 2 * 0.025**2), rel=0.01)
    phantom = shepp_logan.make((96, 96, 96))
    total = sum(v * 4 / 3 * np.pi * a * b * c for v, a, b, c, *_ in shepp_logan.ELLIPSOIDS)
    assert integral(phantom) == pytest.approx(total, rel=0.01)
    levels = phantom([[0, 0.9, 0], [0, 0, 0], [0.22, 0, 0], [0, 0.35, -0.15]])  # skull to lesion
    np.testing.assert_allclose(levels, [1, 0.2, 0, 0.3], atol=1e-6)
    ramp = slab.make((2, 2, 50))
    depth = ramp.values[:, 0, 0].sum(dtype=float) * ramp.spacing[2]
    assert depth == pytest.approx(2 * slab.FIRST + 2 * slab.SLOPE, rel=1e-6)
    assert np.exp(-depth) == pytest.approx(0.030197, rel=1e-4)


@pytest.mark.quick
def test_smoke_is_seeded_and_fades_out():
    again = smoke.make((24, 24, 24))
    np.testing.assert_array_equal(smoke.make((24, 24, 24)).values, again.values)
    assert not np.array_equal(smoke.make((24, 24, 24), seed=1).values, again.values)
    assert again.range[0] == 0
    assert again.values[0, 0].max() == 0  # outside of the ball
    assert again.values[[0, -1]].max() < 2 / 24
    assert again.values[8:16, 8:16, 8:16].mean() > 0.3


# What info tells


def run(*words):
    return CliRunner().invoke(main, [str(word) for word in words])


@pytest.mark.filterwarnings("default:.*was averaged")
def test_info(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    small.by_itk("a.nii.gz")
    shown = run("info", "a.nii.gz", "-o", "a.png")
    assert shown.exit_code == 0, shown.output
    for text in ("6 × 5 × 4 voxels of int16", "0.5 × 0.75 × 2 mm", "turned by 28.9°", "z → head"):
        assert text in shown.output
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")
    record = json.loads(run("info", "a.nii.gz", "--downsample", 2, "--json").stdout)
    assert (record["size"], record["unit"], record["labels"]) == ([3, 3, 2], "mm", False)
    assert sum(record["counts"]) == 18
    assert "labels" in run("info", "a.nii.gz", "--labels").output
    tissues = np.repeat(np.arange(4, dtype=np.uint8), 250)
    tissues.tofile("tissues_10x10x10_uint8.raw")
    told = run("info", "tissues_10x10x10_uint8.raw", "--downsample", 2)
    assert "4 different values, all whole, and was averaged" in told.output
    (tmp_path / "tissues_10x10x10_uint8.raw").unlink()
    for words, sentence in {
        ("car_paint", "--labels"): "car_paint is no volume",
        ("none.nrrd",): "there is no such file",
    }.items():
        refused = run("info", *words)
        assert refused.exit_code == 2
        assert sentence in refused.output
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.nii.gz", "a.png"]


def test_a_summary_of_a_known_volume():
    """Half of the voxels 0, half 200; steep at one face; two values look like labels."""
    voxels = np.zeros((10, 10, 10), np.uint8)
    voxels[5:] = 200
    found = summarise(bk.volumes.Volume(voxels, np.diag([1, 1, 4, 1])))
    assert (found.least, found.largest, found.mean, found.different) == (0, 200, 100, 2)
    assert found.steepest == pytest.approx(25)
    assert found.counts[0] == found.counts[-1] == 500
    assert found.joint_histogram.sum() == 1000
    assert found.joint_histogram[-1].sum() == 200
    assert found.directions == ("+x", "+y", "+z")
    assert any("perhaps labels" in finding for finding in found.findings())
    assert any("4 times as long as wide" in finding for finding in found.findings())
    assert "<table" in found._repr_html_()
    clipped = np.minimum(np.arange(1000).reshape(10, 10, 10), 900).astype(np.uint16)
    (told,) = summarise(bk.volumes.Volume(clipped)).findings()
    assert "perhaps clipped" in told
    assert summarise(bk.volumes.Volume(np.ones((2, 2, 2)))).findings() == (
        "all voxels have the same value",
    )
    flipped = bk.volumes.Volume(voxels, np.diag([-1, -1, 1, 1]), axes="RAS")
    assert summarise(flipped).directions == ("left", "back", "head")
