"""The virtual goniometer against geometry, Mitsuba's own BSDFs, theory and statistics.

Most specimens are tiny tiles, so that rays cross many of them: what is tested is the measurement,
not how well a tile stands for its kind of surface. Bounds of statistical tests are 4.5 standard
errors unless said otherwise, which chance exceeds once in 150,000 comparisons.
"""

import functools
import tracemalloc

import numpy as np
import pytest
from scipy import stats

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.geometry.directions import from_angles
from brdfkit.materials.goniometer import measure, measuring, microgeometry
from brdfkit.materials.goniometer.measuring import Tally
from brdfkit.materials.goniometer.microgeometry import (
    HeightField,
    brushed,
    gaussian,
    make_height_field,
    woven,
)
from brdfkit.materials.goniometer.specimen import Specimen

pytestmark = pytest.mark.usefixtures("llvm_variant")

FLAT = HeightField(np.zeros((16, 16)))
WHITE = {"type": "diffuse", "reflectance": 1.0}
GREY = {"type": "diffuse", "reflectance": 0.5}
GOLD = {"type": "roughconductor", "material": "Au", "distribution": "ggx", "alpha": 0.3}
PLASTIC = {"type": "roughplastic", "diffuse_reflectance": 0.3, "alpha": 0.2}
BOUND = 4.5  # standard errors


@functools.cache
def tile(name, size=64, **parameters):
    """A microgeometry on a small tile."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(microgeometry, "SIZE", size)
        return make_height_field(name, **parameters)


def fixed(surface):
    """The surface at one azimuth."""
    return HeightField(surface.heights, False, surface.parts, surface.part)


def pairs(*degrees):
    """wi, wo (n, 3) of (theta_i, theta_o, phi_o - phi_i) [degrees], at some azimuth."""
    theta_i, theta_o, phi = np.radians(degrees, dtype=float).T
    return from_angles(theta_i, 0.3), from_angles(theta_o, phi + 0.3)


def draw_direction_pairs(n, most=80, seed=0):
    """wi, wo (n, 3), evenly over the angles up to `most` [degrees]."""
    rng = np.random.default_rng(seed)
    theta, phi = np.radians(rng.uniform(0, most, (2, n))), rng.uniform(0, 2 * np.pi, (2, n))
    return from_angles(theta, phi)


def brdf(specimen, wi, wo, spp, seed=0):
    """Mean and standard error (n, 3)."""
    tally, pair = Tally(len(wi)), np.repeat(np.arange(len(wi)), spp)
    tally.add(pair, specimen.draw_samples(wi, wo, pair, seed))
    return tally.mean, tally.standard_error


def albedo(specimen, wo, spp, seed=0):
    """∫ f cosθ_i dω_i of one direction wo, with its standard error, by random wi."""
    u, v = np.random.default_rng(seed).random((2, spp))
    wi = from_angles(np.arccos(np.sqrt(u)), 2 * np.pi * v)
    samples = np.pi * specimen.draw_samples(wi, np.tile(wo, (spp, 1)), np.arange(spp), seed)[:, 0]
    return samples.mean(), samples.std() / np.sqrt(spp)


def tiled_mesh(mi, surface, times, bsdf=None):
    """`times`² tiles of a surface around the origin as one plain mesh: points, triangles, scene."""
    heights = np.pad(np.tile(surface.heights, (times, times)), (0, 1), mode="wrap")
    n = len(heights)
    i, j = np.mgrid[:n, :n]
    points = np.stack([i - (n - 1) / 2, j - (n - 1) / 2, heights], axis=-1).reshape(-1, 3)
    a = (i * n + j)[:-1, :-1].ravel()
    triangles = np.concatenate(
        [np.stack([a, a + n, a + n + 1], 1), np.stack([a, a + n + 1, a + 1], 1)]
    )
    properties = mi.Properties()
    properties["bsdf"] = mi.load_dict(bsdf or GREY)
    mesh = mi.Mesh("tiles", len(points), len(triangles), properties)
    parameters = mi.traverse(mesh)
    parameters["vertex_positions"] = mi.Float(points.ravel().astype(np.float32))
    parameters["faces"] = mi.UInt32(triangles.ravel().astype(np.uint32))
    parameters.update()
    return points, triangles, mesh


# The surfaces


@pytest.mark.quick
@pytest.mark.parametrize("slope", [0.05, 0.3, 1.0])
def test_a_gaussian_surface_has_the_slope_asked_for(slope):
    heights = gaussian(slope, seed=1).heights
    slopes = np.stack([np.roll(heights, -1, axis) - heights for axis in (0, 1)])
    assert np.sqrt(np.mean(slopes**2)) == pytest.approx(slope, rel=1e-9)
    assert abs(heights.mean()) < 1e-9
    # some 4,000 independent bumps: quantiles of a normal distribution to a few per cent
    expected = slope * stats.norm.ppf([0.025, 0.16, 0.5, 0.84, 0.975])
    assert np.allclose(
        np.quantile(slopes, [0.025, 0.16, 0.5, 0.84, 0.975]), expected, atol=0.06 * slope
    )


@pytest.mark.quick
def test_brushed_grooves_run_along_x():
    heights = brushed(slope=0.4, stretch=6).heights
    along, across = (np.std(np.roll(heights, -1, axis) - heights) for axis in (0, 1))
    assert across == pytest.approx(0.4, rel=0.1)
    assert across / along == pytest.approx(6, rel=0.15)


@pytest.mark.quick
def test_warp_and_weft_alternate():
    cloth = woven()
    assert cloth.part.mean() == pytest.approx(0.5, abs=0.03)
    width = len(cloth.heights) // 8
    crossings = cloth.part[width // 2 :: width, width // 2 :: width]
    assert np.array_equal(crossings, np.indices((8, 8)).sum(axis=0) % 2)


@pytest.mark.quick
def test_the_triangles_cover_the_tile_and_its_margin():
    cloth = tile("woven")
    n = len(cloth.heights)
    area = 0
    for part in (0, 1):
        corners = cloth.vertices()[cloth.faces(part)]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        assert (normal[:, 2] > 0).all()
        area += normal[:, 2].sum() / 2
    assert area == pytest.approx((n + 2) ** 2)


# What is known exactly


def test_a_flat_diffuse_surface():
    wi, wo = draw_direction_pairs(20, most=89)
    mean, error = brdf(Specimen(FLAT, {"type": "diffuse", "reflectance": 0.3}), wi, wo, 100)
    assert np.allclose(mean, 0.3 / np.pi, rtol=1e-5)
    assert error.max() < 1e-5


@pytest.mark.parametrize("facets", [GOLD, PLASTIC], ids=lambda f: f["type"])
def test_a_flat_surface_is_its_facets(llvm_variant, facets):
    mi = llvm_variant
    wi, wo = draw_direction_pairs(20, most=85)
    mean, _ = brdf(Specimen(FLAT, facets), wi, wo, 100)
    si = mi.SurfaceInteraction3f()
    si.wi = mi.Vector3f(wo.T.astype(np.float32))
    values = mi.load_dict(facets).eval(mi.BSDFContext(), si, mi.Vector3f(wi.T.astype(np.float32)))
    assert np.allclose(mean, np.array(values).T / wi[:, 2:], rtol=1e-4)


def test_single_bounces_by_an_integral_over_the_surface(llvm_variant):
    """The second form of the formula in `specimen.py`: random points of the surface in place of
    random lines, and shadows by a mesh of 11 × 11 tiles in place of rays that come in again."""
    mi = llvm_variant
    surface = tile("gaussian", slope=0.3)
    wi, wo = pairs(
        (10, 50, 140), (40, 60, 0), (60, 60, 180), (80, 80, 180), (86, 80, 90), (20, 87, 50)
    )
    mean, error = brdf(Specimen(fixed(surface), GREY, max_bounces=1), wi, wo, 2**17)

    points, triangles, mesh = tiled_mesh(mi, surface, 11)
    scene = mi.load_dict({"type": "scene", "tiles": mesh})
    rng = np.random.default_rng(0)
    n = 2**18
    middle = np.abs(points[triangles].mean(axis=1))[:, :2].max(axis=1) < len(surface.heights) / 2
    a, b, c = np.moveaxis(points[rng.choice(triangles[middle], n)], 1, 0)
    normal = np.cross(b - a, c - a)  # its z is 1, twice a triangle's area in the plane
    area = np.linalg.norm(normal, axis=1)  # of the surface per area in the plane
    normal /= area[:, None]
    u, v = np.sqrt(rng.random(n))[:, None], rng.random(n)[:, None]
    p = a * (1 - u) + b * (u * (1 - v)) + c * (u * v) + 1e-3 * normal

    def seen(w):
        ray = mi.Ray3f(mi.Point3f(p.T.astype(np.float32)), mi.Vector3f(*map(float, w)))
        return ~np.array(scene.ray_test(ray)) * np.maximum(normal @ w, 0) / w[2]

    for k in range(len(wi)):
        samples = 0.5 / np.pi * area * seen(wi[k]) * seen(wo[k])
        total = np.hypot(samples.std() / np.sqrt(n), error[k, 0])
        assert abs(samples.mean() - mean[k, 0]) < BOUND * total


# Energy


@pytest.mark.parametrize("name", ["gaussian", "brushed", "woven"])
def test_a_white_furnace_loses_nothing(name):
    """Of paths longer than 100 bounces nothing is seen here."""
    specimen = Specimen(tile(name, slope=0.6), WHITE, max_bounces=100)
    for theta in (0, 45, 75, 85):
        found, error = albedo(specimen, from_angles(np.radians(theta), 0.5), 2**16, seed=theta)
        assert error < 0.02
        assert abs(found - 1) < BOUND * error


def test_a_table_of_a_white_surface_integrates_to_one():
    """Within the noise and the table's coarse cells, together 2 %."""
    table = measure(tile("gaussian", slope=0.4), WHITE, shape=(12, 12, 16), max_bounces=50).table
    theta, phi = (np.arange(100) + 0.5) / 100 * np.pi / 2, (np.arange(100) + 0.5) / 100 * 2 * np.pi
    wo = from_angles(*np.meshgrid(theta, phi, indexing="ij"))
    weight = wo[..., 2] * np.sin(theta)[:, None] * (np.pi / 2 / 100) * (2 * np.pi / 100)
    for theta_i in np.radians([10, 40, 70]):
        wi = np.broadcast_to(from_angles(theta_i, 0), wo.shape)
        values = table.eval(wi.reshape(-1, 3), wo.reshape(-1, 3))
        assert weight.ravel() @ values == pytest.approx(np.ones(3), abs=0.02)


@pytest.mark.parametrize("theta", [20, 75])
def test_a_furnace_by_mitsubas_path_tracer(llvm_variant, theta):
    """Grey facets under a white sky, 9 × 9 tiles without tricks: how often light bounces."""
    mi = llvm_variant
    surface, wo = tile("gaussian", slope=0.8), from_angles(np.radians(theta), 0.5)
    *_, mesh = tiled_mesh(mi, surface, 9)
    sensor = {
        "type": "distant",
        "direction": [float(-x) for x in wo],
        "target": {"type": "rectangle", "to_world": mi.ScalarTransform4f().scale(32)},
        "film": {"type": "hdrfilm", "width": 1, "height": 1, "rfilter": {"type": "box"}},
    }
    path = {"type": "path", "max_depth": 30, "rr_depth": 30}
    sky = {"type": "constant"}
    scene = mi.load_dict({"type": "scene", "tiles": mesh, "sky": sky, "sensor": sensor, "by": path})
    passes = [np.array(mi.render(scene, spp=2**13, seed=s)).mean() for s in range(8)]
    found, error = albedo(Specimen(fixed(surface), GREY), wo, 2**17)
    total = np.hypot(np.std(passes, ddof=1) / np.sqrt(8), error)
    assert total < 0.004
    assert abs(found - np.mean(passes)) < BOUND * total


# Reciprocity, theory


@pytest.mark.parametrize(
    ("surface", "facets"),
    [("gaussian", GOLD), ("brushed", PLASTIC), ("woven", [GOLD, PLASTIC])],
    ids=lambda x: x if isinstance(x, str) else "",
)
def test_reciprocal_within_the_errors(surface, facets):
    """χ² of 60 pairs measured both ways; chance gives p < 1e-5 once in 100,000."""
    specimen = Specimen(tile(surface), facets)
    wi, wo = draw_direction_pairs(60, most=75)
    (there, error), (back, other) = (
        brdf(specimen, *both, 2**13, seed) for seed, both in enumerate([(wi, wo), (wo, wi)])
    )
    z = ((there - back) / np.hypot(error, other))[:, 0]
    assert 1e-5 < stats.chi2.sf(np.sum(z**2), len(z)) < 1 - 1e-5


def test_shiny_gaussian_facets_are_beckmanns(llvm_variant):
    """Slopes add up: alpha² = 2 slope² + facet_alpha². One bounce, within 55° of the normal.

    A tile has some 4,000 bumps, of which few face a given way: ±3 % from tile to tile.
    """
    mi = llvm_variant
    mirrors = {"type": "roughconductor", "material": "none", "alpha": 0.1}
    specimen = Specimen(gaussian(slope=0.2), mirrors, max_bounces=1)
    wi, wo = draw_direction_pairs(200, most=55)
    facing = (wi + wo)[:, 2] / np.linalg.norm(wi + wo, axis=1) > np.cos(np.radians(22))
    wi, wo = wi[facing], wo[facing]
    mean, error = brdf(specimen, wi, wo, 2**13)
    assert (error < 0.05 * mean).all()
    si = mi.SurfaceInteraction3f()
    si.wi = mi.Vector3f(wi.T.astype(np.float32))
    bsdf = mi.load_dict(mirrors | {"alpha": float(np.sqrt(2 * 0.2**2 + 0.1**2))})
    values = bsdf.eval(mi.BSDFContext(), si, mi.Vector3f(wo.T.astype(np.float32)))
    ratio = mean[:, 0] / (np.array(values)[0] / wo[:, 2])
    assert len(ratio) > 30
    assert ratio.mean() == pytest.approx(1, abs=0.03)
    assert np.abs(ratio - 1).max() < 0.15


# Statistics


@pytest.mark.quick
def test_a_tally_is_mean_and_standard_error():
    rng = np.random.default_rng(0)
    samples, pair = rng.gamma(2, size=(300, 3)), np.sort(rng.integers(0, 5, 300))
    tally = Tally(5)
    for part in (slice(0, 100), slice(100, 300)):
        tally.add(pair[part], samples[part])
    for k in range(5):
        mine = samples[pair == k]
        assert tally.n[k] == len(mine)
        assert np.allclose(tally.mean[k], mine.mean(axis=0))
        assert np.allclose(tally.standard_error[k], mine.std(axis=0, ddof=1) / np.sqrt(len(mine)))


def test_standard_errors_are_honest_and_the_values_unbiased():
    """20 seeds: their spread by their own errors, and their mean by a run of fixed length.

    Sums over 85 or so cells, of which the channels are alike.
    """
    surface = tile("gaussian")
    runs = [measure(surface, GOLD, shape=(5, 5, 5), error=0.1, spp=2048, seed=s) for s in range(20)]
    valid = runs[0].samples.valid
    values, errors = (
        np.array([getattr(r, a)[valid, 0] for r in runs]) for a in ("values", "standard_error")
    )
    freedom = 19 * valid.sum()
    chi2 = np.sum((values - values.mean(axis=0)) ** 2 / np.mean(errors**2, axis=0))
    assert chi2 / freedom == pytest.approx(1, abs=BOUND * np.sqrt(2 / freedom))

    wi, wo = runs[0].samples.wi[valid], runs[0].samples.wo[valid]
    reference, error = brdf(Specimen(surface, GOLD), wi, wo, 2**13, seed=99)
    total = np.hypot(error[:, 0], values.std(axis=0, ddof=1) / np.sqrt(20))
    z = np.sum((values.mean(axis=0) - reference[:, 0]) / total) / np.sqrt(valid.sum())
    assert abs(z) < BOUND


def test_the_errors_come_out_as_asked():
    found = measure(tile("gaussian"), GREY, shape=(6, 6, 6), error=0.02, spp=10**5)
    valid = found.samples.valid
    relative = found.standard_error[valid, 0] / found.values[valid, 0]
    # a pilot of 64 samples knows a standard deviation to some 20 %
    assert np.quantile(relative, 0.95) < 0.02 * 1.3
    assert np.median(relative) > 0.02 / 4


def test_equal_seeds_give_equal_values():
    first, second, other = (
        measure(tile("woven"), GOLD, shape=(3, 3, 3, 3), seed=s) for s in (4, 4, 5)
    )
    assert first.anisotropic
    assert first.values.tobytes() == second.values.tobytes()
    assert first.standard_error.tobytes() == second.standard_error.tobytes()
    assert not np.array_equal(first.values, other.values, equal_nan=True)


class Recorder:
    """A specimen of one value, which keeps what it was asked for."""

    def __init__(self):
        self.pairs, self.seeds = [], []

    def draw_samples(self, light, eye, pair, seed):
        self.pairs.append(pair)
        self.seeds.append(seed)
        return np.ones((len(pair), 3))


@pytest.mark.quick
def test_the_order_of_the_samples_is_that_of_the_cells(monkeypatch):
    """The shipped tables come from it."""
    monkeypatch.setattr(measuring, "BATCH", 7)
    counts, recorder = np.array([3, 0, 9, 1, 1, 8, 0]), Recorder()
    tally = Tally(len(counts))
    measuring._add_samples(recorder, None, None, counts, np.random.default_rng(5), tally)
    assert [len(pair) for pair in recorder.pairs] == [7, 7, 7, 1]
    assert np.array_equal(np.concatenate(recorder.pairs), np.repeat(np.arange(7), counts))
    random = np.random.default_rng(5)
    assert recorder.seeds == [int(random.integers(2**32)) for _ in range(4)]
    assert np.array_equal(tally.n, counts)


@pytest.mark.quick
def test_many_samples_need_the_memory_of_one_batch(monkeypatch):
    monkeypatch.setattr(measuring, "BATCH", 100)
    tally, counts = Tally(3), np.full(3, 10**7)

    def stop(done, total):
        raise KeyboardInterrupt

    tracemalloc.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            measuring._add_samples(
                Recorder(), None, None, counts, np.random.default_rng(), tally, stop
            )
        assert tracemalloc.get_traced_memory()[1] < 10**6
    finally:
        tracemalloc.stop()


# Interrupted; wrong


class Interrupt:
    """Progress that is told to stop after some calls."""

    def __init__(self, after):
        self.left = after

    def __call__(self, done, total):
        self.left -= 1
        if not self.left:
            raise KeyboardInterrupt


def test_ctrl_c_keeps_what_there_is(monkeypatch):
    monkeypatch.setattr("brdfkit.materials.goniometer.measuring.BATCH", 5_000)
    options = {"surface": tile("gaussian"), "facets": GREY, "shape": (5, 5, 5), "error": 0.02}
    whole, part = measure(**options), measure(**options, progress=Interrupt(after=30))
    assert "interrupted" in part.info
    assert "interrupted" not in whole.info
    valid = whole.samples.valid
    assert np.array_equal(part.samples.valid, valid)
    assert (part.standard_error[valid] > whole.standard_error[valid]).mean() > 0.95
    with pytest.raises(KeyboardInterrupt):
        measure(**options, progress=Interrupt(after=1))


@pytest.mark.quick
@pytest.mark.parametrize(
    ("said", "options"),
    [
        ("3 numbers", {"shape": (4, 4)}),
        ("3 numbers", {"shape": (4, 4, 0)}),
        ("error = 0", {"error": 0}),
        ("error = nan", {"error": np.nan}),
        ("error = 1e-200", {"error": 1e-200}),
        ("over 4,194,304 cells", {"shape": (10**5,) * 3}),
        ("over 4,194,304 cells", {"shape": (2**32,) * 3}),
        ("spp = 1 ", {"spp": 1}),
        ("between 2 and", {"spp": 10**20}),
        ("seed = -1", {"seed": -1}),
        ("max_bounces = 0", {"max_bounces": 0}),
        ("surface = 3 should be", {"surface": 3}),
        ("facets = 'Au' should be", {"facets": "Au"}),
        ("3 materials", {"facets": [GREY] * 3}),
        ("nope", {"facets": {"type": "nope"}}),
        ("mirror", {"facets": {"type": "conductor"}}),
        ("let light through", {"facets": {"type": "roughdielectric"}}),
    ],
)
def test_what_cannot_be_measured(said, options):
    with pytest.raises(BrdfkitError, match=said):
        measure(**({"surface": FLAT, "facets": GREY, "shape": (3, 3, 3)} | options))


@pytest.mark.quick
@pytest.mark.parametrize(
    ("said", "name", "parameters"),
    [
        ("gaussian, brushed", "bumpy", {}),
        ("slope = 0", "gaussian", {"slope": 0}),
        ("seed = -1", "gaussian", {"seed": -1}),
        ("seed = -1", "woven", {"seed": -1}),
        ("slope = nan", "brushed", {"slope": np.nan}),
        ("stretch = 0.5", "brushed", {"stretch": 0.5}),
        ("thickness = 2", "woven", {"thickness": 2}),
        (
            "gaussian: there is no parameter 'stretch'; there are slope, seed",
            "gaussian",
            {"stretch": 2},
        ),
    ],
)
def test_surfaces_that_cannot_be(said, name, parameters):
    with pytest.raises(BrdfkitError, match=said):
        make_height_field(name, **parameters)


@pytest.mark.quick
@pytest.mark.parametrize("variant", ["scalar_rgb", "llvm_ad_spectral"])
def test_a_variant_that_cannot(llvm_variant, variant):
    llvm_variant.set_variant(variant)
    with pytest.raises(BrdfkitError, match=f"{variant}; set llvm_ad_rgb"):
        Specimen(FLAT, GREY)
