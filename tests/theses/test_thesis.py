"""Acceptance checks of the thesis (Kurt 2007) on the parameters it prints for CUReT.

The thesis fitted each colour channel; the measurements at hand are an average over the channels on
a scale of its own, so that each sample is first brought to the albedo that is printed for it. The
digest says how the convention was found, and which printed rows are no data.
"""

import csv
from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest
from brdfkit.theses.kurt2007.appendix_3 import SHAPES
from brdfkit.theses.kurt2007.curet import PLAIN, evaluate_lobes
from random_models import random_model

import brdfkit as bk
from brdfkit.core.geometry.directions import from_angles
from brdfkit.materials.measured.selection import select_samples
from brdfkit.model.lobes import HalfVector
from brdfkit.model.microfacet import Beckmann
from brdfkit.regression import losses

TWO_LOBES = sorted(set(SHAPES) - {"oren_nayar"})


@dataclass
class Row:
    """A printed fit beside the measurements it was made from."""

    sample: int
    model: str
    shapes: dict
    printed: np.ndarray  # (lobes, RGB): k_d, k_s
    error: float
    data: "Sample"
    lobes: np.ndarray  # (lobes, n) of ours at the printed shape parameters

    @property
    def usable(self):
        """Coefficients below 0 were printed as 0, beside the error of the fit that had them; and
        one error is illegible."""
        return bool((self.printed != 0).all()) and np.isfinite(self.error)


@dataclass
class Sample:
    """A CUReT material: what is measured, and the weights of eq. 5.13."""

    wi: np.ndarray
    wo: np.ndarray
    values: np.ndarray
    cosines: np.ndarray
    weights: np.ndarray

    @classmethod
    def of(cls, data):
        samples = select_samples(data, 80)
        weights, cosines = losses.named["kurt"].weights(samples.wi[:, 2]), samples.wi[:, 2]
        return cls(samples.wi, samples.wo, samples.values[:, 0], cosines, weights)

    def solve(self, lobes, weights=None):
        """The best coefficients (lobes,), of any sign as in the thesis."""
        root = np.sqrt(self.weights if weights is None else weights) * self.cosines
        return np.linalg.lstsq((lobes * root).T, self.values * root, rcond=None)[0]

    def error(self, difference, weights=None):
        """E of eq. 5.13 for differences (n,) of the BRDF."""
        weights = self.weights if weights is None else weights
        return np.sqrt(np.average((difference * self.cosines) ** 2, weights=weights))


@pytest.fixture
def rows(measured_data):
    if not (measured_data.parent / "thesis" / "curet_fits.csv").exists():
        pytest.skip("the thesis's table of parameters is not beside the measurements")
    return rows_of(measured_data)


@cache
def rows_of(folder):
    """Every `Row` of the appendix."""
    curet, samples = folder / "curet" / "abrdf.dat", {}
    with open(folder.parent / "thesis" / "curet_fits.csv", newline="") as file:
        table = list(csv.DictReader(file))
    for number in {line["curet_sample"] for line in table}:
        samples[number] = Sample.of(bk.load(f"{curet}#{number}"))
    return [row_of(line, samples[line["curet_sample"]]) for line in table]


def row_of(line, data):
    name = line["model"].replace("-", "_")
    shapes = {s: float(line[f"p{i}"]) for i, s in enumerate(SHAPES[name])}
    weights = ("kd",) if name == "oren_nayar" else ("kd", "ks")
    printed = np.array([[float(line[f"{k}_{c}"]) for c in "rgb"] for k in weights])
    error = float(line["l2_error"] or "nan")
    lobes = evaluate_lobes(name, shapes, data.wi, data.wo).T
    return Row(int(line["curet_sample"]), name, shapes, printed, error, data, lobes)


def scales(rows, weights=None):
    """Measured over printed albedo by sample: of Oren-Nayar, whose one coefficient it is."""
    return {
        row.sample: row.data.solve(row.lobes, weights)[0] / row.printed[0].mean()
        for row in rows
        if row.model == "oren_nayar"
    }


def ratios(rows, lobes=lambda row: row.lobes, weights=None):
    """E at the printed parameters over the printed E; `lobes` of a row may be others than ours.

    The squares of the three channels are summed: one channel's E grows by |k_d| / mean k_d.
    """
    scale = scales(rows, weights)
    return np.array([ratio(r, lobes(r), scale[r.sample], weights) for r in rows if r.usable])


def ratio(row, lobes, scale, weights):
    k_d = row.printed[0]
    difference = row.data.values / scale - row.printed.mean(axis=1) @ lobes
    return row.data.error(difference, weights) * np.linalg.norm(k_d) / k_d.mean() / row.error


def of_model(rows, name):
    return [row for row in rows if row.model == name]


def specular_ratio(rows, name, weights=None):
    """Median of k_s by least squares over the printed one."""
    scale, usable = scales(rows, weights), [r for r in of_model(rows, name) if r.usable]
    solved = [r.data.solve(r.lobes, weights)[1] / scale[r.sample] for r in usable]
    return np.median(solved / np.array([r.printed[1].mean() for r in usable]))


def scatter(ratios):
    return np.log(ratios).std()


def test_printed_errors_come_back(rows):
    """Median 1.02 ± .02 of the ratio, log-scatter ≤ .15, correlation ≥ .97 over 282 rows."""
    found, printed = ratios(rows), np.array([row.error for row in rows if row.usable])
    assert len(rows) == 364
    assert len(found) == 282
    assert np.median(found) == pytest.approx(1.02, abs=0.02)
    assert scatter(found) <= 0.15
    assert np.corrcoef(found * printed, printed)[0, 1] >= 0.97


@pytest.mark.parametrize("name", TWO_LOBES)
def test_printed_specular_coefficients_come_back(name, rows):
    """Which holds the constant before each specular term, to 2 %."""
    assert 0.98 <= specular_ratio(rows, name) <= 1.01


@pytest.mark.parametrize(("name", "expected"), [("blinn_phong", 0.68), ("ward", 0.80)])
def test_other_weights_miss_the_specular_coefficients(name, expected, rows):
    """A negative control of w = sin θ_i: with w = 1 two models are far off."""
    ones = np.ones_like(rows[0].data.weights)
    assert specular_ratio(rows, name, ones) == pytest.approx(expected, abs=0.01)


def misprinted(row):
    """Oren-Nayar with the bracket of eq. 3.23, which closes too early."""
    wi, wo = row.data.wi, row.data.wo
    sines = np.sqrt((1 - wi[:, 2] ** 2) * (1 - wo[:, 2] ** 2))
    cos_phi = (wi[:, :2] * wo[:, :2]).sum(axis=1) / np.maximum(sines, 1e-12)
    s = row.shapes["sigma"] ** 2
    A, B = 1 - 0.5 * s / (s + 0.33), 0.45 * s / (s + 0.09)
    sin_tan = sines / np.maximum(wi[:, 2], wo[:, 2])
    return ((A + B * np.maximum(0, cos_phi)) * sin_tan / np.pi)[None]


def turned(row):
    """Our lobes with φ_r + 180°, as if the mirror direction were at Δφ = 0."""
    return evaluate_lobes(row.model, row.shapes, row.data.wi, row.data.wo * [-1, -1, 1]).T


def test_misprinted_oren_nayar_misses_the_errors(rows):
    """By 2.4 with w = 1, where the digest has its figure from (the right form: 0.95, which it
    gives too), and by 1.9 with the weight of the thesis."""
    rows, ones = of_model(rows, "oren_nayar"), np.ones_like(rows[0].data.weights)
    assert np.median(ratios(rows, weights=ones)) == pytest.approx(0.95, abs=0.01)
    assert np.median(ratios(rows, misprinted, ones)) == pytest.approx(2.4, abs=0.05)
    assert np.median(ratios(rows)) == pytest.approx(1.0, abs=0.01)
    assert np.median(ratios(rows, misprinted)) == pytest.approx(1.92, abs=0.02)


def test_turned_azimuth_misses_the_errors(rows):
    """The log-scatter of Oren-Nayar grows from .19 to .51: the mirror is at Δφ = 180°."""
    rows = of_model(rows, "oren_nayar")
    assert scatter(ratios(rows)) == pytest.approx(0.19, abs=0.01)
    assert scatter(ratios(rows, turned)) == pytest.approx(0.51, abs=0.02)


@cache
def refitted(folder, name):
    """Median of the exponent of a fit of the model `name` over the printed one of Blinn-Phong."""
    rows = [row for row in of_model(rows_of(folder), "blinn_phong") if row.usable]
    curet = folder / "curet" / "abrdf.dat"
    fits = [bk.fit(bk.load(f"{curet}#{r.sample}"), name, loss="kurt", starts=4) for r in rows]
    printed = np.array([row.shapes["exponent"] for row in rows])
    return np.median(np.array([fit.values["exponent"] for fit in fits]) / printed)


def test_printed_exponents_are_those_of_the_half_vector(rows, measured_data):
    """And not of the mirror direction, which needs less than half of them."""
    assert refitted(measured_data, "blinn_phong") == pytest.approx(1, abs=0.05)
    assert refitted(measured_data, "phong") < 0.45


@pytest.mark.parametrize(("name", "digest"), [("blinn_phong", 0.92), ("phong", 0.34)])
@pytest.mark.xfail(strict=True, reason="found 1.035 and 0.408; the digest's rows are not told")
def test_refitted_exponents_of_the_digest(name, digest, rows, measured_data):
    """At w = 1 and with free signs they come nearer, 0.95 and 0.36, but not to these figures."""
    assert refitted(measured_data, name) == pytest.approx(digest, abs=0.01)


@pytest.mark.parametrize(("loss", "expected"), [(PLAIN, 36), ("kurt", 39)])
def test_on_how_many_samples_the_polynomial_wins(loss, expected, rows, measured_data):
    """Degree 7 has the lowest error of eight, ± 2; the thesis prints 35 of 52. By bisquare, which
    takes longer, see docs/reproduce/kurt2007.md."""
    won = 0
    for row in of_model(rows, "oren_nayar"):
        data = bk.load(measured_data / "curet" / f"abrdf.dat#{row.sample}")
        values = bk.fit(data, "pca_polynomial:degree=7", loss=loss).eval(row.data.wi, row.data.wo)
        others = [r for r in rows if r.sample == row.sample]
        # To the thesis's scale: by the errors at its shape parameters, with the best weights
        ours = [r.data.error(r.data.values - r.data.solve(r.lobes) @ r.lobes) for r in others]
        scale = np.nanmedian([r.error for r in others] / np.array(ours))
        error = scale * row.data.error(values[:, 0] - row.data.values)
        won += error < np.nanmin([r.error for r in others])
    assert won == pytest.approx(expected, abs=2)


def test_reciprocity(configured):
    """To 1e-12 of the value over 10⁴ pairs up to the horizon; a polynomial to the last digit."""
    rng = np.random.default_rng(9)
    wi, wo = from_angles(np.arccos(rng.random((2, 10_000))), 2 * np.pi * rng.random((2, 10_000)))
    for seed in range(3):
        model = random_model(configured, seed)
        forth, back = model.eval(wi, wo), model.eval(wo, wi)
        tolerance = 0 if configured.type_name() == "pca_polynomial" else 1e-12
        np.testing.assert_allclose(forth, back, rtol=tolerance, atol=0)


@pytest.mark.parametrize(
    ("alpha", "degrees", "expected"), [(0.2, 60, 0.9683), (0.2, 80, 0.7278), (0.5, 60, 0.7461)]
)
def test_share_of_wards_samples_above_the_horizon(alpha, degrees, expected, llvm_variant):
    """Of 2·10⁶ half vectors (eqs. 4.23, 4.24): the rest has weight 0."""
    mi = llvm_variant
    sampler = mi.load_dict({"type": "independent"})
    sampler.seed(0, wavefront_size=2_000_000)
    wi = mi.Vector3f(*from_angles(np.radians(degrees), 0.0).tolist())
    wo = HalfVector(Beckmann(alpha, alpha)).sample(wi, sampler.next_2d())
    assert np.mean(np.asarray(wo.z) > 0) == pytest.approx(expected, abs=2e-3)
