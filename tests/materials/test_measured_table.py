"""Measured materials in the renderer: looked up in every variant, sampled by what they hold."""

import lzma
from functools import cache

import drjit as dr
import numpy as np
import pytest
from small_files import adaptive, place, rgl_file, written

import brdfkit as bk
from brdfkit.checks.material_subject import (
    INCIDENCES,
    Subject,
    draw_direction_pairs,
    list_incidences,
)
from brdfkit.checks.registry import checks
from brdfkit.checks.sampling import compute_weight_spreads
from brdfkit.core import catalogue
from brdfkit.core.colours import import_colour_package
from brdfkit.core.geometry.directions import from_angles
from brdfkit.mitsuba_bridge.arrays import Rows
from brdfkit.mitsuba_bridge.bsdf.half_vector_table import _draw_cell
from brdfkit.model import labels
from brdfkit.model.samples import Table

VARIANTS = ("llvm_ad_rgb", "llvm_ad_mono", "llvm_ad_spectral", "scalar_rgb", "scalar_spectral")
POLARIZED = ("llvm_ad_mono_polarized", "llvm_ad_spectral_polarized", "scalar_spectral_polarized")
NODES = (450.0, 550.0, 650.0)  # nm


@cache
def brushed(channels=("R", "G", "B"), shape=(24, 40, 24, 36)):
    """An anisotropic material: Ward, tabulated."""
    model = bk.models()["ward"](alpha_u=0.15, alpha_v=0.4, diffuse_reflectance=[0.3, 0.2, 0.1])
    values = np.full((*shape, 3), np.nan)
    wi, wo = Table(values).directions()
    above = (wi[..., 2] > 0) & (wo[..., 2] > 0)
    values[above] = model.eval(wi[above], wo[above])
    return bk.Measured.from_table(values, channels=channels, name="brushed"), model


def test_the_end_of_a_table_is_no_empty_cell():
    """A random number that rounding made 1 gave a direction that was no number."""
    bk.models()
    import mitsuba as mi

    mi.set_variant("llvm_ad_rgb")
    cell, place = _draw_cell(Rows(np.array([0.25, 1, 1])), mi.UInt32(0), 3, mi.Float(1))
    assert cell[0] == 1
    assert place[0] == pytest.approx(1)


@cache
def below_zero(channels=("R", "G", "B")):
    """A highlight, and around it values below 0, as an instrument's zero or a gamut gives them."""
    values = np.full((30, 30, 60, 3), -0.01)
    values[:8] = [0.3, 0.2, 0.1]
    return bk.Measured.from_table(values, channels=channels, name="below zero")


@cache
def in_rgl(channels=("R", "G", "B")):
    """An anisotropic material from a file of RGL's."""
    return adaptive(rgl_file(brushed(channels)[0]))


MATERIALS = {
    "dusty_gold": cache(lambda: bk.load("dusty_gold")),
    "brushed": lambda: brushed()[0],
    "below_zero": below_zero,
    "in_rgl": in_rgl,
}


def seen(mi, bsdf, wi, wo, wavelengths=None):
    """BRDF (channels,) of one pair of directions, as NumPy."""
    si = dr.zeros(mi.SurfaceInteraction3f)
    si.wi = mi.Vector3f(*map(float, wi))
    if wavelengths is not None:
        si.wavelengths = wavelengths
    value = bsdf.eval(mi.BSDFContext(), si, mi.Vector3f(*map(float, wo)))
    return np.array(mi.unpolarized_spectrum(value)).ravel() / wo[2]


def seen_at(mi, bsdf, wi, wo, wavelengths):
    """BRDF (n, 4) of one pair of directions at wavelengths (n, 4), at once where it is possible."""
    if mi.variant().startswith("scalar"):
        return np.array([seen(mi, bsdf, wi, wo, row.tolist()) for row in wavelengths])
    si = dr.zeros(mi.SurfaceInteraction3f, len(wavelengths))
    si.wi = mi.Vector3f(*map(float, wi))
    si.wavelengths = mi.UnpolarizedSpectrum(wavelengths.T.astype(np.float32))
    value = bsdf.eval(mi.BSDFContext(), si, mi.Vector3f(*map(float, wo)))
    return np.array(mi.unpolarized_spectrum(value)).T / wo[2]


@pytest.mark.parametrize("name", MATERIALS)
@pytest.mark.parametrize("check", sorted(set(checks["bsdfs"]) - {"reciprocity"}))
def test_passes_the_checks(name, check, llvm_variant):
    report = bk.check(MATERIALS[name](), only=[check])
    assert report, str(report)


@pytest.mark.parametrize("name", MATERIALS)
def test_looked_up_as_in_numpy(name, llvm_variant):
    material = MATERIALS[name]()
    wi, wo = draw_direction_pairs(5000, seed=1)
    expected = material.eval(wi, wo)
    found = Subject(material).eval_plugin(wi, wo) / wo[:, 2:]
    np.testing.assert_allclose(found, expected, rtol=2e-3, atol=1e-4 * expected.max())


def test_an_anisotropic_table_is_its_material():
    """The finer, the closer: by the square of the cells' size, as what is linear between them."""
    wi, wo = draw_direction_pairs(5000, seed=2, max_degrees=75)
    off = []
    for shape in ((12, 20, 12, 18), (24, 40, 24, 36)):
        material, model = brushed(shape=shape)
        found, expected = material.eval(wi, wo), model.eval(wi, wo)
        off.append(np.percentile(np.abs(found / expected - 1), (50, 90)))
    assert (off[1] < [2e-3, 0.025]).all(), off
    assert (off[0] > 3 * off[1]).all(), off


@pytest.mark.parametrize("name", MATERIALS)
@pytest.mark.parametrize("label", VARIANTS + POLARIZED)
def test_in_every_variant(name, label, variant):
    """The colour in an rgb variant, its luminance in mono, a spectrum with that colour else."""
    import mitsuba as mi

    material = MATERIALS[name]()
    wi, wo = from_angles(0.6, 0.3), from_angles(0.37, 3.4)  # at the edge of a highlight
    rgb = material.eval(wi[None], wo[None])[0]
    variant(label)
    bsdf = mi.load_dict(material.scene_dict())
    if mi.is_spectral:
        found = colour_of(lambda nm: seen_at(mi, bsdf, wi, wo, nm))
        np.testing.assert_allclose(found, rgb, rtol=4e-3)
    else:
        expected = [rgb @ [0.2126, 0.7152, 0.0722]] if mi.is_monochromatic else rgb
        np.testing.assert_allclose(seen(mi, bsdf, wi, wo), expected, rtol=2e-3)


def colour_of(spectrum):
    """Linear sRGB under D65 of a reflectance, `spectrum` of wavelengths (n, 4)."""
    colour = import_colour_package()

    nm = np.arange(380.0, 780.0, 5.0)
    values = spectrum(nm.reshape(-1, 4)).ravel()
    observer = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"].copy()
    light = colour.SDS_ILLUMINANTS["D65"].copy()
    shape = colour.SpectralShape(380, 775, 5)
    weights = observer.align(shape).values * light.align(shape).values[:, None]
    rgb = weights @ colour.RGB_COLOURSPACES["sRGB"].matrix_XYZ_to_RGB.T
    return values @ rgb / rgb.sum(axis=0)


@pytest.mark.parametrize("label", ["llvm_ad_spectral", "scalar_spectral"])
@pytest.mark.parametrize("make", [lambda nodes: brushed(nodes)[0], below_zero, in_rgl])
def test_measured_wavelengths_stay(label, make, variant):
    """Between the wavelengths the BRDF is linear, beyond them constant."""
    import mitsuba as mi

    variant(label)
    material = make(tuple(f"{nm:.0f}nm" for nm in NODES))
    bsdf = mi.load_dict(material.scene_dict())
    wi, wo = from_angles(0.6, 0.3), from_angles(0.37, 3.4)
    at = material.eval(wi[None], wo[None])[0]
    np.testing.assert_allclose(seen(mi, bsdf, wi, wo, [*NODES, 500.0])[:3], at, rtol=1e-4)
    between = seen(mi, bsdf, wi, wo, [500.0, 625.0, 380.0, 800.0])
    expected = [at[:2].mean(), 0.25 * at[1] + 0.75 * at[2], at[0], at[2]]
    np.testing.assert_allclose(between, expected, rtol=1e-4)


@pytest.mark.quick
@pytest.mark.parametrize("shape", [(5, 4, 8), (6, 4, 3, 8), (7, 4, 3, 9)])
def test_an_unknown_cell_takes_the_nearest(shape):
    """The azimuths wrap; found by looking at all known cells."""
    values = np.full((np.prod(shape), 1), np.nan)
    known = np.random.default_rng(9).choice(len(values), 4, replace=False)
    values[known, 0] = np.arange(4)
    cells = np.indices(shape).reshape(len(shape), -1).T
    apart = np.abs(cells[:, None] - cells[known])
    for azimuth in (2,) if len(shape) == 3 else (0, 3):
        apart[..., azimuth] = np.minimum(apart, shape[azimuth] - apart)[..., azimuth]
    distance = np.linalg.norm(apart, axis=-1)
    taken = Table(values.reshape(*shape, 1)).filled_values.astype(int).reshape(-1, 1)
    np.testing.assert_array_equal(np.take_along_axis(distance, taken, 1)[:, 0], distance.min(1))


SCENE = """<scene version="3.0.0"><shape type="sphere"><bsdf type="{}">
<string name="filename" value="{}"/></bsdf></shape></scene>"""
FOUND = {
    "below_zero.npz": ("measured_table", "MeasuredTable"),
    "abrdf.dat#2": ("measured_table", "MeasuredTable"),
    "dusty_gold": ("measured_table", "MeasuredTable"),
    "paint.bsdf": ("measured_adaptive", "MeasuredAdaptive"),
    "paint.bsdf.xz": ("measured_table", "MeasuredTable"),  # its table, where that is asked for
}


@pytest.mark.parametrize("parallel", [False, True])
def test_a_file_lies_beside_its_scene(parallel, tmp_path, monkeypatch, llvm_variant):
    """As Mitsuba finds bitmaps, and not from where the program runs; a sample of it, too."""
    (scenes := tmp_path / "scenes").mkdir()
    bk.save(below_zero(), scenes / "below_zero.npz")
    place(scenes, "curet")
    place(scenes, "rgl, written")
    place(scenes, "rgl, written", lzma.compress(written()["rgl, written"][1]), "paint.bsdf.xz")
    monkeypatch.chdir(tmp_path)
    for name, (plugin, shown) in FOUND.items():
        (scenes / "scene.xml").write_text(SCENE.format(plugin, name))
        scene = llvm_variant.load_file("scenes/scene.xml", parallel=parallel)
        assert shown in str(scene.shapes()[0].bsdf())


@pytest.mark.quick
@pytest.mark.parametrize(
    ("entries", "said"),
    [
        ({"type": "measured_adaptive"}, "measured_adaptive needs a filename"),
        (
            {"type": "measured_adaptive", "filename": "dusty_gold"},
            "dusty_gold is no RGL file; give it to measured_table",
        ),
        ({"type": "measured_table"}, "measured_table needs a filename"),
    ],
)
def test_says_what_file_it_needs(entries, said, llvm_variant):
    with pytest.raises(RuntimeError, match=said):
        llvm_variant.load_dict(entries)


@pytest.mark.parametrize("name", MATERIALS)
def test_albedo_image(name, llvm_variant):
    """The diffuse reflectance that an albedo image asks for is the albedo at the incidence."""
    subject = Subject(material := MATERIALS[name]())
    for degrees, wi in list_incidences()[:4]:
        found = np.array(
            subject.bsdf.eval_diffuse_reflectance(subject.make_interaction(wi))
        ).ravel()
        np.testing.assert_allclose(found, bk.albedo(material, wi), rtol=0.02, err_msg=str(degrees))


def cosine_spread(material, degrees):
    """Standard deviation over mean of the weights by cosine sampling."""
    wi = dict(list_incidences())[degrees]
    rng = np.random.default_rng(3)
    u, phi = rng.random(200_000), rng.random(200_000) * 2 * np.pi
    wo = from_angles(np.arcsin(np.sqrt(u)), phi)
    weights = material.eval(np.broadcast_to(wi, wo.shape), wo).mean(axis=1)
    return weights.std() / weights.mean()


@pytest.mark.parametrize("name", [*catalogue.list_materials(), "brushed"])
def test_weights_of_samples_vary_little(name, llvm_variant):
    """Standard deviation ≤ 0.5 of the mean at every incidence, and never worse than by cosine."""
    material = MATERIALS.get(name, lambda: bk.load(name))()
    spreads = compute_weight_spreads(Subject(material), samples=200_000)
    for degrees, found in zip(INCIDENCES, spreads, strict=True):
        assert found <= 0.5
        assert found <= max(cosine_spread(material, degrees), 0.25), degrees


GLOSSY = ("minidiff_paints/C10_Copper.astm.xz", "minidiff_paints/C1_White.astm.xz")
GLOSSY += ("minidiff_paints/C8_Silver.astm.xz", "cornell/cayman.brdf")
RGL = tuple(
    f"rgl/{name}_rgb.bsdf" for name in ("cc_ibiza_sunset", "satin_rosaline", "acrylic_felt_green")
)


@pytest.mark.parametrize("name", GLOSSY + RGL)
def test_real_materials_are_sampled_well(name, measured_data, llvm_variant):
    subject = Subject(bk.load(measured_data / name).rgb)
    spreads = compute_weight_spreads(subject, samples=200_000)[:4]
    assert max(spreads) <= 0.5, spreads
    for check in ("chi squared", "coverage"):
        passed, figure = checks["bsdfs"][check](subject)
        assert passed, (check, figure)


@pytest.mark.parametrize("name", RGL)
def test_a_format_s_own_lookup_keeps_its_albedo(name, measured_data, llvm_variant):
    """What is rendered and what `eval` looks up reflect the same light, near the horizon too."""
    material = bk.load(measured_data / name)
    for degrees in (0.1, 5, 30, 60, 75):
        wi = from_angles(np.radians(degrees), 0.3)
        np.testing.assert_allclose(
            bk.albedo(material.table, wi), bk.albedo(material, wi), rtol=0.02, atol=1e-3
        )


def test_at_normal_incidence_all_sides_count():
    """An isotropic file may say there what depends on the azimuth: the mean is rendered."""

    def uneven(wi, wo):
        sine = np.hypot(wo[:, 0], wo[:, 1])
        phi = np.arctan2(wo[:, 1], wo[:, 0]) - np.arctan2(wi[:, 1], wi[:, 0])
        return (1 + 0.5 * sine * np.cos(2 * phi))[:, None] / np.pi

    wi, wo = draw_direction_pairs(100, seed=4)
    material = bk.Measured.from_samples(wi, wo, uneven(wi, wo), channels=("Y",), lookup=uneven)
    for degrees in (0, 1, 2, 4, 45):
        albedo = bk.albedo(material.table, from_angles(np.radians(degrees), 0.3))
        assert albedo == pytest.approx(1, rel=0.03), degrees


# Scattered samples

# back to the light, and a highlight
BACK_AND_FORTH = {
    "diffuse_reflectance": 0.1,
    "specular_reflectance": 0.4,
    "c_x": 0.7,
    "c_z": 0.7,
    "exponent": 300.0,
    "specular_reflectance_2": 0.05,
    "exponent_2": 20.0,
}


@pytest.fixture(scope="module")
def goniometer():
    """The directions of a goniometer like the Mini-Diff: θ_i to 60°, θ_o to 75°."""
    theta_i, theta_o, phi = np.meshgrid([0, 20, 40, 60], np.arange(0, 76), np.arange(0, 360, 10))
    wi = from_angles(np.radians(theta_i.ravel()), np.pi)
    return wi, from_angles(np.radians(theta_o.ravel()), np.radians(phi.ravel()))


@pytest.mark.parametrize("name", ["dusty_gold", "red_plastic", "car_paint"])
def test_between_and_beyond_samples(name, goniometer):
    """A table measured anew at a goniometer's angles comes back: where it was not measured, too."""
    truth = bk.load(name)
    found = bk.Measured.from_samples(*goniometer, truth.eval(*goniometer))
    wi, wo = draw_direction_pairs(5000, seed=4, max_degrees=75)
    off = np.abs(np.log(found.eval(wi, wo) / truth.eval(wi, wo)))
    assert np.median(off) < 0.03
    for degrees, tolerance in ((0, 0.03), (45, 0.04), (85, 0.2)):
        wi = from_angles(np.radians(degrees), 0.0)
        np.testing.assert_allclose(
            bk.albedo(found, wi).mean(), bk.albedo(truth, wi).mean(), rtol=tolerance
        )


@pytest.mark.parametrize("paint", ["C1_White", "C2_Black", "C3_Red", "C6_Green", "C7_Brown"])
def test_beyond_measured_angles_no_more_light_leaves_than_comes(paint, measured_data):
    """Their ratio to the guide rises towards 60°, from where on nothing was measured."""
    found = bk.load(measured_data / "minidiff_paints" / f"{paint}.astm.xz")
    for degrees in (75, 85, 89):
        assert (bk.albedo(found, from_angles(np.radians(degrees), 0.0)) < 1.01).all(), degrees
    wi, wo = draw_direction_pairs(5000, seed=7)
    np.testing.assert_allclose(found.eval(wi, wo), found.eval(wo, wi), rtol=1e-9)


def test_a_retroreflective_peak_stays_where_it_was_measured(goniometer):
    """Its neighbours at the same theta_h, a few degrees of theta_d away, are not in it."""
    truth = labels.model("lafortune:lobe_count=2")(**BACK_AND_FORTH)
    found = bk.Measured.from_samples(*goniometer, truth.eval(*goniometer), channels=("Y",))
    wi = from_angles(np.radians(40), 0.0)
    np.testing.assert_allclose(bk.albedo(found, wi), bk.albedo(truth, wi), rtol=0.2)


@pytest.mark.quick
def test_samples_come_back():
    """In any number of channels, at any height; and the BRDF is positive and reciprocal."""
    rng = np.random.default_rng(5)
    wi, wo = draw_direction_pairs(200, seed=6, max_degrees=85)
    values = np.exp(rng.normal(0, 2, (200, 5)))
    found = bk.Measured.from_samples(wi, wo, values, channels=[f"{k}nm" for k in range(5)])
    np.testing.assert_allclose(found.eval(wi, wo), values, rtol=1e-6)
    np.testing.assert_allclose(found.eval(wo, wi), values, rtol=1e-6)
    wi, wo = draw_direction_pairs(2000, seed=7)
    assert (found.eval(wi, wo) > 0).all()
    np.testing.assert_allclose(found.eval(wi, wo), found.eval(wo, wi), rtol=1e-9)


@pytest.mark.quick
@pytest.mark.parametrize("anisotropic", [False, True])
def test_few_black_or_equal_samples(anisotropic):
    """What determines no highlight still is a material."""
    wi, wo = draw_direction_pairs(100, seed=8, max_degrees=80)
    for n, value in ((1, 0.2), (3, 0.2), (100, 0.2), (100, 0.0)):
        values = np.full((n, 1), value)
        found = bk.Measured.from_samples(
            wi[:n], wo[:n], values, channels=("Y",), anisotropic=anisotropic
        )
        expected = np.full((100, 1), value)
        np.testing.assert_allclose(found.eval(wi, wo), expected, rtol=1e-3, atol=1e-9)
