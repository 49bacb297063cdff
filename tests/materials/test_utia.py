"""UTIA's tables: their order and lookup, against the loops that UTIA's own program has."""

import math

import numpy as np
import pytest
from small_files import place, spectrum, table, utia

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.geometry.directions import from_angles
from brdfkit.materials.loading import load, save
from brdfkit.materials.measured import Measured

pytestmark = pytest.mark.quick


def filip(numbers, theta_i, phi_i, theta_v, phi_v):
    """R, G, B by the published loops over the file's flat numbers, angles in degrees."""

    def theta_cell(theta):
        lower = min(int(theta // 15), 4)
        upper = (theta - 15 * lower) / 15
        return (lower, 1 - upper), (lower + 1, upper)

    def phi_cell(phi):
        lower = int(phi // 7.5)
        upper = (phi - 7.5 * lower) / 7.5
        return (lower, 1 - upper), ((lower + 1) % 48, upper)

    rgb = [0.0, 0.0, 0.0]
    for plane in range(3):
        for i, weight_i in theta_cell(theta_i):
            for j, weight_j in theta_cell(theta_v):
                for k, weight_k in phi_cell(phi_i):
                    for n, weight_n in phi_cell(phi_v):
                        index = plane * 288 * 288 + 288 * (48 * i + k) + 48 * j + n
                        rgb[plane] += numbers[index] * weight_i * weight_j * weight_k * weight_n
    return rgb


def noise():
    """A positive table that is smooth nowhere, and constant over phi at theta = 0."""
    grid = 1 + np.random.default_rng(0).random((3, 6, 48, 6, 48))
    grid[:, 0] = grid[:, 0, :1]
    grid[:, :, :, 0] = grid[:, :, :, 0, :1]
    return grid


def test_lookup_is_that_of_utia(tmp_path):
    numbers = noise().ravel()
    material = load(place(tmp_path, "utia", numbers.astype("<f8").tobytes()))
    random = np.random.default_rng(1)
    theta_i, theta_v = random.uniform(0.1, 89, (2, 50))  # above 75°, too
    phi_i, phi_v = random.uniform(0, 360, (2, 50))
    angles = np.stack([theta_i, phi_i, theta_v, phi_v], axis=1)
    expected = np.maximum([filip(numbers, *row) for row in angles], 0)
    wi = from_angles(*np.radians([theta_i, phi_i]))
    wo = from_angles(*np.radians([theta_v, phi_v]))
    np.testing.assert_allclose(material.eval(wi, wo), expected, rtol=1e-9)


def test_samples_are_met_by_the_lookup(tmp_path):
    material = load(place(tmp_path, "utia", noise().astype("<f8").tobytes()))
    samples = material.samples
    assert material.anisotropic
    assert len(material.values) == 288 * 288
    np.testing.assert_allclose(material.eval(samples.wi, samples.wo), material.values, rtol=1e-9)


def test_light_first_then_view(tmp_path):
    material = load(place(tmp_path, "utia"))
    grazing, steep = from_angles([math.radians(75)], [1.0]), from_angles([math.radians(30)], [2.0])
    np.testing.assert_allclose(material.eval(grazing, steep), [[1.5, 0.75, 0.25]], rtol=1e-12)
    assert "not document" in material.info["unit"]


def test_negative_values_are_kept(tmp_path):
    numbers = np.frombuffer(utia(), "<f8").copy()
    numbers[7] = -0.5
    material = load(place(tmp_path, "utia", numbers.tobytes()))
    assert material.values.min() == -0.5
    save(material, tmp_path / "again.bin")
    assert (tmp_path / "again.bin").read_bytes() == numbers.tobytes()


def test_other_materials_are_interpolated(tmp_path):
    grey = Measured.from_table(np.full((9, 9, 18, 1), 0.25), channels=("Y",))
    save(grey, tmp_path / "grey.bin")
    np.testing.assert_allclose(load(tmp_path / "grey.bin").values, 0.25)
    for material in (table(), spectrum()):
        save(material, tmp_path / "other.bin")
        back = load(tmp_path / "other.bin")
        wi, wo = back.samples.wi[5000::999], back.samples.wo[5000::999]
        np.testing.assert_allclose(back.eval(wi, wo), material.rgb.eval(wi, wo), atol=1e-9)


@pytest.mark.parametrize(
    ("data", "match"),
    [
        (utia()[:-1], "has 1,990,655 bytes where 1,990,656 belong"),
        (utia() + b"\0", "has 1,990,657 bytes"),
        (b"\0" * 6 + b"\xf8\x7f" + utia()[8:], r"1 samples are not finite"),
    ],
    ids=["cut short", "too long", "not a number"],
)
def test_traps(tmp_path, data, match):
    with pytest.raises(BrdfkitError, match=rf"paint\.bin: {match}"):
        load(place(tmp_path, "utia", data))
