"""The materials that come with brdfkit: index, files, checksums, and that they are real BRDFs."""

import hashlib
import importlib.util
import shutil

import numpy as np
import pytest

from brdfkit.core import catalogue
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import read_bytes
from brdfkit.core.geometry.directions import from_angles, to_half_difference
from brdfkit.materials.loading import load

NAMES = sorted(catalogue.list_materials())
TABULATED = [n for n in NAMES if catalogue.list_materials()[n].file.endswith(".binary.xz")]
MEASURED = [n for n in NAMES if n not in TABULATED]
LIMIT = 400_000  # bytes: they are in the repository and in the wheel


@pytest.fixture(scope="module")
def measured():
    return {name: load(catalogue.find_material_file(name)) for name in NAMES}


@pytest.fixture(scope="module")
def make():
    """The program that made the tables, as a module."""
    spec = importlib.util.spec_from_file_location("make", catalogue.find_data_folder() / "make.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def copy(tmp_path, monkeypatch):
    """A copy of the folder, to spoil."""
    folder = tmp_path / "measured"
    shutil.copytree(catalogue.find_data_folder(), folder)
    monkeypatch.setattr(catalogue, "find_data_folder", lambda kind=catalogue.MEASURED: folder)
    return folder


def draw_direction_pairs(n, seed=0):
    """Direction pairs above the surface, half of them near each other's mirror direction."""
    rng = np.random.default_rng(seed)
    wi, wo = from_angles(np.arccos(rng.uniform(0.15, 1, (2, n))), rng.uniform(0, 2 * np.pi, (2, n)))
    near = wi * [-1, -1, 1] + rng.normal(0, 0.1, wi.shape)
    near /= np.linalg.norm(near, axis=1, keepdims=True)
    wo = np.where((np.arange(n) % 2 == 0)[:, None] & (near[:, 2:] > 0.15), near, wo)
    return wi, wo


def assert_same(values, errors, others, other_errors):
    """Two measurements of the same values, in their green channel; the others are alike.

    Every cell within 8 standard errors, which allows for the long tails of cells that few paths
    reach; the means of all differences, and of their squares less the errors', within 4.5 of their
    own errors, which chance exceeds once in 150,000 times. Both are relative to the values, not to
    each cell's errors: a cell whose samples missed the rare bright paths is low, and sure of it.
    """
    known = np.isfinite(values[..., 1])
    values, errors, others, other_errors = (
        x[known, 1] for x in (values, errors, others, other_errors)
    )
    assert len(values) > 100
    total = np.hypot(errors, other_errors)
    # weighted by the errors, for then the difference of both does not depend on their mean
    share = np.mean(errors**2) / np.mean(total**2)
    mean = (1 - share) * values + share * others
    difference = (values - others) / mean
    assert (np.abs(values - others) < 8 * total).all()
    for x in (difference, difference**2 - (total / mean) ** 2):
        assert abs(x.mean()) < 4.5 * x.std() / np.sqrt(len(x))


@pytest.mark.quick
def test_index_and_files_are_one_to_one(make):
    files = {file.name for file in catalogue.find_data_folder().glob("*.xz")}
    entries = [material.file for material in catalogue.list_materials().values()]
    assert sorted(entries) == sorted(files)
    assert sorted(make.TABULATED) == TABULATED
    assert sorted(make.MEASURED) == MEASURED
    readme = (catalogue.find_data_folder() / "README.md").read_text(encoding="utf-8")
    assert all(f"| `{name}` |" in readme for name in NAMES)


@pytest.mark.quick
@pytest.mark.parametrize("name", NAMES)
def test_entries_say_all_and_checksums_are_right(name):
    material = catalogue.list_materials()[name]
    assert material.name == name == material.file.split(".")[0]
    assert material.licence == "BSD-3-Clause"
    assert material.source.endswith(f"make.py {name}")
    assert all(text in str(material) for text in (name, material.title, material.what))
    file = catalogue.find_material_file(name)
    assert hashlib.sha256(file.read_bytes()).hexdigest() == material.sha256
    assert file.stat().st_size <= LIMIT


@pytest.mark.quick
def test_a_name_that_is_none():
    with pytest.raises(BrdfkitError, match=r"no material 'gold'; there are .*dusty_gold"):
        catalogue.find_material_file("gold")


@pytest.mark.quick
def test_a_changed_or_missing_file_is_refused(copy):
    file = catalogue.find_material_file("car_paint")
    assert file.parent == copy
    spoilt = bytearray(file.read_bytes())
    spoilt[len(spoilt) // 2] ^= 1
    file.write_bytes(spoilt)
    with pytest.raises(BrdfkitError, match=r"checksum differs.*install brdfkit again\.$"):
        catalogue.find_material_file("car_paint")
    file.unlink()
    with pytest.raises(BrdfkitError, match=r"'car_paint' is missing"):
        catalogue.find_material_file("car_paint")
    assert catalogue.find_material_file("dusty_gold").exists()


@pytest.mark.parametrize("name", NAMES)
def test_all_above_the_surface_is_known_and_positive(measured, name):
    material = measured[name]
    samples = material.samples
    above = (samples.wi[:, 2] > 0) & (samples.wo[:, 2] > 0)
    assert material.is_table
    assert material.name == name
    assert material.channels == ("R", "G", "B")
    assert material.table.phi_d_period == np.pi
    assert np.array_equal(samples.valid, above)
    assert np.isnan(samples.values[~above]).all()
    assert samples.values[above].min() > 1e-3


@pytest.mark.quick
@pytest.mark.parametrize("name", NAMES)
def test_reciprocal(measured, name):
    wi, wo = draw_direction_pairs(5000)
    assert np.allclose(measured[name].eval(wo, wi), measured[name].eval(wi, wo), rtol=1e-9)


@pytest.mark.quick
@pytest.mark.parametrize("name", TABULATED)
def test_mirror_symmetric(measured, name):
    wi, wo = draw_direction_pairs(5000)
    flip = np.array([1, -1, 1])
    values = measured[name].eval(wi, wo)
    assert np.allclose(measured[name].eval(wi * flip, wo * flip), values, rtol=1e-3)


@pytest.mark.quick
@pytest.mark.parametrize("name", MEASURED)
def test_mirror_symmetric_within_the_errors(measured, name):
    """Both halves of an isotropic table are independent measurements of the same values."""
    material = measured[name]
    values = material.table.values
    errors = material.standard_error.reshape(values.shape)
    assert np.array_equal(np.isnan(errors), np.isnan(values))
    if not material.anisotropic:
        half = values.shape[2] // 2
        assert_same(
            values[:, :, :half],
            errors[:, :, :half],
            *(x[:, :, : -half - 1 : -1] for x in (values, errors)),
        )


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("theta_i", [0, 30, 60, 75, 85])
def test_albedo_is_at_most_one(measured, name, theta_i):
    n = 400
    theta = (np.arange(n) + 0.5) / n * np.pi / 2
    phi = (np.arange(n) + 0.5) / n * np.pi  # half of it: the other is its mirror image
    wo = from_angles(*np.meshgrid(theta, phi, indexing="ij"))
    weight = 2 * wo[..., 2] * np.sin(theta)[:, None] * (np.pi / 2 / n) * (np.pi / n)
    wi = np.broadcast_to(from_angles(np.radians(theta_i), 0), wo.shape)
    assert weight.sum() == pytest.approx(np.pi, rel=1e-5)
    values = measured[name].eval(wi.reshape(-1, 3), wo.reshape(-1, 3))
    albedo = weight.ravel() @ values
    assert (albedo > 0.04).all()
    assert (albedo < 1).all()


@pytest.mark.quick
@pytest.mark.parametrize("name", NAMES)
def test_encoded_again_the_content_is_the_same(measured, make, name):
    material = measured[name]
    again = make.packed(material) if name in MEASURED else make.encoded(material.table.values)
    assert again == read_bytes(catalogue.find_material_file(name))


@pytest.mark.quick
def test_rounding_is_as_fine_as_it_says(make):
    x = np.random.default_rng(0).lognormal(0, 10, 10_000)
    rounded = make.rounded(x)
    assert np.abs(rounded / x - 1).max() <= 1.6e-5
    assert np.array_equal(make.rounded(rounded), rounded)
    assert make.rounded(np.array([0.0, -1.0])).tolist() == [0, -1]


@pytest.mark.parametrize("name", TABULATED)
def test_the_program_makes_what_is_shipped(measured, make, module_in_llvm, name):
    made, catalogue = make.tabulate(name), measured[name].table.values
    assert np.array_equal(np.isnan(made), np.isnan(catalogue))
    assert np.allclose(made, catalogue, rtol=1e-4, equal_nan=True)


@pytest.mark.parametrize("name", MEASURED)
def test_measured_again_the_values_agree(measured, make, module_in_llvm, name):
    """Other samples of the same specimen, at every third cell along each axis: of a third as many
    cells, the centres are among the table's."""
    catalogue = measured[name].table
    third = tuple(slice(1, None, 3) for _ in catalogue.shape)
    cells = ",".join(str(n // 3) for n in catalogue.shape)
    again = make.measured(name, "--shape", cells, "--seed", "1", "--error", "0.1", "--spp", "1024")
    assert np.allclose(again.table.directions()[0], catalogue.directions()[0][third], atol=1e-12)
    errors = measured[name].standard_error.reshape(catalogue.values.shape)[third]
    other = again.standard_error.reshape(again.table.values.shape)
    assert_same(catalogue.values[third], errors, again.table.values, other)


@pytest.mark.parametrize("name", TABULATED)
def test_a_lookup_gives_the_bsdf_between_the_cells(measured, make, module_in_llvm, name):
    wi, wo = draw_direction_pairs(20_000, seed=1)
    wi, wo = (w[to_half_difference(wi, wo)[1] < np.radians(75)] for w in (wi, wo))
    bsdf = module_in_llvm.load_dict(make.TABULATED[name]())
    error = np.abs(measured[name].eval(wi, wo) / make.evaluate(bsdf, wi, wo) - 1).max(axis=1)
    assert np.median(error) < 0.006
    assert np.percentile(error, 99) < 0.05
