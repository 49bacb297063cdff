"""The materials that come with brdfkit: index, files, checksums, and that they are real BRDFs."""

import hashlib
import importlib.util
import shutil

import numpy as np
import pytest

from brdfkit import catalogue
from brdfkit.directions import from_angles, to_half_difference
from brdfkit.errors import BrdfkitError
from brdfkit.files import contents
from brdfkit.formats import load

NAMES = sorted(catalogue.materials())
LIMIT = 400_000  # bytes: they are in the repository and in the wheel


@pytest.fixture(scope="module")
def measured():
    return {name: load(catalogue.path(name)) for name in NAMES}


@pytest.fixture(scope="module")
def make():
    """The program that made the tables, as a module."""
    spec = importlib.util.spec_from_file_location("make", catalogue.folder() / "make.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def variant():
    mi = pytest.importorskip("mitsuba")
    before = mi.variant()
    mi.set_variant("llvm_ad_rgb")
    yield mi
    if before:
        mi.set_variant(before)


@pytest.fixture
def copy(tmp_path, monkeypatch):
    """A copy of the folder, to spoil."""
    folder = tmp_path / "measured"
    shutil.copytree(catalogue.folder(), folder)
    monkeypatch.setattr(catalogue, "folder", lambda: folder)
    return folder


def random_pairs(n, seed=0):
    """Direction pairs above the surface, half of them near each other's mirror direction."""
    rng = np.random.default_rng(seed)
    wi, wo = from_angles(np.arccos(rng.uniform(0.15, 1, (2, n))), rng.uniform(0, 2 * np.pi, (2, n)))
    near = wi * [-1, -1, 1] + rng.normal(0, 0.1, wi.shape)
    near /= np.linalg.norm(near, axis=1, keepdims=True)
    wo = np.where((np.arange(n) % 2 == 0)[:, None] & (near[:, 2:] > 0.15), near, wo)
    return wi, wo


@pytest.mark.quick
def test_index_and_files_are_one_to_one(make):
    files = {file.name for file in catalogue.folder().glob("*.xz")}
    entries = [material.file for material in catalogue.materials().values()]
    assert sorted(entries) == sorted(files)
    assert sorted(make.MATERIALS) == NAMES
    readme = (catalogue.folder() / "README.md").read_text(encoding="utf-8")
    assert all(f"| `{name}` |" in readme for name in NAMES)


@pytest.mark.quick
@pytest.mark.parametrize("name", NAMES)
def test_entries_say_all_and_checksums_are_right(name):
    material = catalogue.materials()[name]
    assert material.name == name == material.file.split(".")[0]
    assert material.licence == "BSD-3-Clause"
    assert material.source.endswith(f"make.py {name}")
    assert all(text in str(material) for text in (name, material.title, material.what))
    file = catalogue.path(name)
    assert hashlib.sha256(file.read_bytes()).hexdigest() == material.sha256
    assert file.stat().st_size <= LIMIT


@pytest.mark.quick
def test_a_name_that_is_none():
    with pytest.raises(BrdfkitError, match=r"no material 'gold'; there are .*dusty_gold"):
        catalogue.path("gold")


@pytest.mark.quick
def test_a_changed_or_missing_file_is_refused(copy):
    file = catalogue.path("car_paint")
    assert file.parent == copy
    spoilt = bytearray(file.read_bytes())
    spoilt[len(spoilt) // 2] ^= 1
    file.write_bytes(spoilt)
    with pytest.raises(BrdfkitError, match=r"checksum differs.*install brdfkit again\.$"):
        catalogue.path("car_paint")
    file.unlink()
    with pytest.raises(BrdfkitError, match=r"'car_paint' is missing"):
        catalogue.path("car_paint")
    assert catalogue.path("dusty_gold").exists()


@pytest.mark.quick
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
def test_reciprocal_and_mirror_symmetric(measured, name):
    wi, wo = random_pairs(5000)
    values = measured[name].eval(wi, wo)
    assert np.allclose(measured[name].eval(wo, wi), values, rtol=1e-9)
    flip = [1, -1, 1]
    assert np.allclose(measured[name].eval(wi * flip, wo * flip), values, rtol=1e-3)


@pytest.mark.quick
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
    assert make.encoded(measured[name].table.values) == contents(catalogue.path(name))


@pytest.mark.quick
def test_rounding_is_as_fine_as_it_says(make):
    x = np.random.default_rng(0).lognormal(0, 10, 10_000)
    rounded = make.rounded(x)
    assert np.abs(rounded / x - 1).max() <= 1.6e-5
    assert np.array_equal(make.rounded(rounded), rounded)
    assert make.rounded(np.array([0.0, -1.0])).tolist() == [0, -1]


@pytest.mark.parametrize("name", NAMES)
def test_the_program_makes_what_is_shipped(measured, make, variant, name):
    made, shipped = make.tabulate(name), measured[name].table.values
    assert np.array_equal(np.isnan(made), np.isnan(shipped))
    assert np.allclose(made, shipped, rtol=1e-4, equal_nan=True)


@pytest.mark.parametrize("name", NAMES)
def test_a_lookup_gives_the_bsdf_between_the_cells(measured, make, variant, name):
    wi, wo = random_pairs(20_000, seed=1)
    wi, wo = (w[to_half_difference(wi, wo)[1] < np.radians(75)] for w in (wi, wo))
    bsdf = variant.load_dict(make.MATERIALS[name]())
    error = np.abs(measured[name].eval(wi, wo) / make.evaluate(bsdf, wi, wo) - 1).max(axis=1)
    assert np.median(error) < 0.006
    assert np.percentile(error, 99) < 0.05
