"""The formats on real files, found through BRDFKIT_DATA; skipped where it is not set."""

import os
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import cKDTree

from brdfkit.core.colours import RGB
from brdfkit.core.files import read_bytes
from brdfkit.core.geometry.directions import from_angles
from brdfkit.materials.formats import HEAD, list_formats
from brdfkit.materials.loading import load, save

DATA = Path(os.environ.get("BRDFKIT_DATA", "unset"))
pytestmark = pytest.mark.skipif(not DATA.is_dir(), reason="BRDFKIT_DATA names no folder")

CORNELL = sorted(DATA.glob("cornell/*.brdf")) + sorted(DATA.glob("cornell/*.astm"))
MINI_DIFF = sorted(DATA.glob("minidiff_paints/*.astm*"))
ALTA = sorted(DATA.glob("alta_retro/*.dat.xz"))
SUFFIXES = {suffix for module in list_formats() for suffix in module.SUFFIXES}
EVERY = [p for p in sorted(DATA.rglob("*.*")) if SUFFIXES & set(p.suffixes) and "npz" not in p.name]
EVERY = [p for p in EVERY if p.stem != "CHECKSUMS"]  # a table, but of no samples


@pytest.mark.parametrize("path", EVERY, ids=lambda path: path.name)
def test_every_file_is_read_by_one_format(path):
    head = read_bytes(path)[:HEAD]
    assert sum(module.sniff(head) for module in list_formats()) == 1
    material = load(f"{path}#1" if path.name == "abrdf.dat" else path)
    valid = material.samples.at(material.samples.valid)
    assert np.isfinite(valid.values).all()
    assert valid.values.max() > 0


def from_mirror(samples):
    """Angle [degrees] of each view from the mirror direction of its illumination."""
    cosine = np.sum(samples.wo * samples.wi * [-1, -1, 1], axis=1)
    return np.degrees(np.arccos(np.clip(cosine, -1, 1)))


@pytest.mark.parametrize("path", CORNELL, ids=lambda path: path.name)
def test_cornell(path):
    material = load(path)
    samples = material.samples
    assert len(material.values) == 1439
    assert samples.valid.all()
    assert material.name == path.name.split(".")[0]
    angle = from_mirror(samples)
    assert angle[np.argmax(samples.values.max(axis=1))] < 1.5
    # at moderate angles as well, where no lone grazing point helps
    moderate = samples.wi[:, 2] > np.cos(np.radians(61))
    brightest = np.argsort(samples.values.max(axis=1) * moderate)[-5:]
    assert (angle[brightest] < 20).all()


@pytest.mark.parametrize(
    ("name", "zeros", "spike"),
    [("acryl_blue", 0.42, False), ("cayman", 0.27, True), ("krylon_blue", 0.03, True)],
)
def test_cornell_notes(name, zeros, spike):
    material = load(DATA / "cornell" / f"{name}.brdf")
    assert (material.values == 0).mean() == pytest.approx(zeros, abs=0.006)
    assert float(material.info["clipped"].split("%")[0]) == pytest.approx(100 * zeros, abs=0.6)
    assert ("suspicious" in material.info) == spike
    assert material.channels == tuple(f"{nm}nm" for nm in range(400, 701, 10))


def test_cornell_file_without_its_end_is_noted(tmp_path):
    """Wherever it is cut, between two rows."""
    lines = (DATA / "cornell" / "cayman.brdf").read_bytes().splitlines(keepends=True)
    assert "incomplete" not in load(DATA / "cornell" / "cayman.brdf").info
    first = len(lines) - 1439
    for rows in (1, 2, 3, 300, 720, 1000, 1300, 1430, 1437, 1438):
        (tmp_path / "cut.brdf").write_bytes(b"".join(lines[: first + rows]))
        material = load(tmp_path / "cut.brdf")
        assert len(material.values) == rows
        assert "rings of views stop short of the mirror" in material.info["incomplete"]


def test_cornell_rgb_file_has_the_lone_point_too():
    info = load(DATA / "cornell" / "krylon_blue_RGB.astm").info
    assert "theta_i 80°, theta_s 79° in the mirror's azimuth is 8.3 times" in info["suspicious"]


def test_cornell_spectra_and_rgb_file_agree():
    """The two files of one sample: linear sRGB here, Trinitron phosphors there."""
    spectra, rgb = (
        load(DATA / "cornell" / n) for n in ("krylon_blue.brdf", "krylon_blue_RGB.astm")
    )
    np.testing.assert_allclose(spectra.samples.wo, rgb.samples.wo, atol=1e-5)
    assert (rgb.values < 0).mean() == pytest.approx(0.218, abs=0.001)
    for ours, theirs in zip(spectra.rgb.values.T, rgb.values.T, strict=True):
        # up to a factor: the RGB file is 0.36 times as bright as the spectra
        assert np.corrcoef(ours, theirs)[0, 1] > 0.9999
        assert ours @ theirs / (theirs @ theirs) == pytest.approx(2.8, abs=0.1)


@pytest.mark.parametrize("path", MINI_DIFF, ids=lambda path: path.name)
def test_mini_diff(path):
    material = load(path)
    samples = material.samples
    theta_s = np.degrees(np.arccos(np.clip(samples.wo[:, 2], -1, 1)))
    assert material.channels == RGB
    assert len(samples.valid) == 12964
    # one row at theta_s = 0 and 36 at each of 1 to 75 degrees, at four angles of incidence
    assert samples.valid.sum() == 4 * (1 + 75 * 36)
    assert theta_s[samples.valid].max() == pytest.approx(75)
    assert theta_s[~samples.valid].min() == pytest.approx(76)
    assert (samples.values[samples.valid] < 0).mean() < 1e-3


def test_mini_diff_conventions():
    gloss = load(DATA / "minidiff_paints/C1_White.astm.xz").samples
    brightest = np.argmax(gloss.values[:, 1] * gloss.valid)
    assert from_mirror(gloss)[brightest] < 3
    assert gloss.values[gloss.valid].max() == pytest.approx(36, abs=1)
    red = load(DATA / "minidiff_paints/C3_Red.astm.xz")
    r, g, b = np.median(red.values[red.samples.valid], axis=0)
    assert r > 3 * max(g, b)
    r, g, b = np.median(load(DATA / "minidiff_paints/C14_NavyBlue.astm.xz").values, axis=0)
    assert b > max(r, g)


def test_curet_every_sample():
    materials = [load(f"{DATA}/curet/abrdf.dat#{sample}") for sample in range(1, 62)]
    negative = [(material.values < 0).sum() for material in materials]
    assert sum(negative) == 29
    assert negative[60] == 28
    assert negative[3] == 1
    everything = np.stack([material.values for material in materials])
    assert everything.max() == pytest.approx(2.59, abs=0.005)
    assert np.median(everything) == pytest.approx(0.146)


def test_curet_geometry():
    samples = load(DATA / "curet" / "abrdf.dat#1").samples
    theta_i, theta_v = (np.arccos(w[:, 2]) for w in (samples.wi, samples.wo))
    near = (np.degrees(theta_i) < 80) & (np.degrees(theta_v) < 80)
    assert near.sum() == 189
    assert np.sin(theta_i[near]).sum() == pytest.approx(136.1973, abs=1e-3)
    assert np.degrees(theta_v).max() == pytest.approx(84, abs=0.5)  # the view goes lower
    assert np.degrees(theta_i).max() == pytest.approx(79, abs=0.5)


@pytest.mark.parametrize("path", ALTA, ids=lambda path: path.name)
def test_alta(path):
    material = load(path)
    samples = material.samples
    assert material.channels == ("Y",)
    assert not material.anisotropic
    theta_l = np.degrees(np.arccos(samples.wi[:, 2]))
    np.testing.assert_allclose(np.unique(theta_l.round(3)), [15, 30, 60])
    # retroreflective: at 30° nothing is brighter than within 2° of the light
    tilted = samples.at(samples.valid & (np.abs(theta_l - 30) < 1))
    brightest = tilted.at([np.argmax(tilted.values[:, 0])])
    assert np.sum(brightest.wi * brightest.wo) > np.cos(np.radians(2))


def test_alta_cosine():
    """Divided by cos theta_v, the values are reciprocal; so they would be in the other file."""
    jaune, gray = (load(path) for path in ALTA)
    assert "divided" in jaune.info["cosine"]
    assert jaune.info["masked"].startswith("86 rows")
    assert "not stated" in gray.info["PARAM_OUT"]
    # 1 for a BRDF; 0.52, the cosines' ratio, for a BRDF × cos theta_v
    assert np.median(exchanged(jaune)) == pytest.approx(1, abs=0.1)
    assert np.median(exchanged(gray)) == pytest.approx(0.52, abs=0.1)


def exchanged(material):
    """f(15° → 60°) / f(60° → 15°) at azimuths all around, each from the nearest sample."""
    phi = np.linspace(0, 2 * np.pi, 200)
    a = from_angles(np.full(200, np.radians(15)), np.zeros(200))
    b = from_angles(np.full(200, np.radians(60)), phi)
    samples = material.samples

    def nearest(wi_z, cosine, wo_z):
        score = [samples.wi[:, 2], np.sum(samples.wi * samples.wo, axis=1), samples.wo[:, 2]]
        points = np.stack([np.arccos(np.clip(s, -1, 1)) for s in score], axis=1)
        wanted = [np.full(200, wi_z), cosine, np.full(200, wo_z)]
        wanted = np.stack([np.arccos(w) for w in wanted], axis=1)
        return samples.values[cKDTree(points).query(wanted)[1], 0]

    cosine = np.sum(a * b, axis=1)
    return nearest(a[0, 2], cosine, b[0, 2]) / nearest(b[0, 2], cosine, a[0, 2])


def test_mini_diff_as_merl(tmp_path):
    material = load(DATA / "minidiff_paints/C11_GalGray.astm.xz")
    save(material, tmp_path / "grey.binary")
    back = load(tmp_path / "grey.binary")
    assert back.table.shape == (90, 90, 180)  # which other programs insist on
    cells = back.samples.at(np.flatnonzero(back.samples.valid)[::97])
    np.testing.assert_allclose(cells.values, material.eval(cells.wi, cells.wo), rtol=1e-12)
