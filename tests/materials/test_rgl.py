"""RGL's files: looked up as Mitsuba's `measured` does, written so that it renders the source."""

import io
import pickle
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
from small_files import adaptive, rgl_file, written

import brdfkit as bk
from brdfkit import checks
from brdfkit.checks.material_subject import (
    Subject,
    draw_direction_pairs,
    list_incidences,
)
from brdfkit.checks.sampling import compute_weight_spreads, draw_uniform_numbers
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.geometry.directions import from_angles
from brdfkit.materials.formats.rgl import encoding, tensor_file
from brdfkit.materials.formats.rgl.encoding import Resolution
from brdfkit.materials.formats.rgl.normals import Hemisphere, find_normal_distribution
from brdfkit.materials.formats.rgl.warp import Warp, find_slices, make_even_grid
from brdfkit.materials.loading import load, save
from brdfkit.materials.measured import Measured
from brdfkit.regression import Fit

DATABASE = (
    "acrylic_felt_green",
    "cc_ibiza_sunset",
    "cc_iris_purple_gem",
    "cg_sunflower",
    "ilm_l3_37_matte",
    "paper_white",
    "satin_rosaline",
)


def rgl():
    """A small file."""
    return written()["rgl, written"][1]


@pytest.fixture
def small_tables(monkeypatch):
    """Files of few nodes, written at once."""
    monkeypatch.setattr(encoding, "ISOTROPIC", Resolution(0, 6, 1, 32, 16))
    monkeypatch.setattr(encoding, "ANISOTROPIC", Resolution(3, 5, 16, 32, 12))


class Rendered(Subject):
    """A file as Mitsuba's `measured` sees it, beside what it was written from."""

    def __init__(self, path, source=None):
        import mitsuba as mi

        scene_dict = {"type": "measured", "filename": str(path)}
        thing = SimpleNamespace(scene_dict=lambda: scene_dict, eval=getattr(source, "eval", None))
        super().__init__(thing)
        self.__dict__["bsdf"] = Above(mi.load_dict(scene_dict))

    def eval(self, wi, wo):
        return self.eval_plugin(wi, wo) / wo[:, 2:]


class Above:
    """`measured` states a density for samples below the surface too, with weight 0: drop them."""

    def __init__(self, bsdf):
        self.bsdf = bsdf

    def __getattr__(self, name):
        return getattr(self.bsdf, name)

    def sample(self, *arguments):
        import drjit as dr

        drawn, weight = self.bsdf.sample(*arguments)
        drawn.pdf = dr.select(drawn.wo.z > 0, drawn.pdf, 0)
        return drawn, weight


def unpacked(data):
    """The fields of a file's bytes, writable."""
    source = SimpleNamespace(data=data, error=BrdfkitError)
    return {name: array.copy() for name, array in tensor_file.read(source).items()}


def packed(fields):
    stream = io.BytesIO()
    tensor_file.write(stream, fields)
    return stream.getvalue()


def pairs(n=20_000, seed=5, degrees=80):
    """Direction pairs, even over angles."""
    rng = np.random.default_rng(seed)
    theta, phi = rng.uniform(0, np.radians(degrees), (2, n)), rng.uniform(-np.pi, np.pi, (2, n))
    return from_angles(theta[0], phi[0]), from_angles(theta[1], phi[1])


def relative(a, b):
    """Relative differences of values, averaged over the channels."""
    b = np.broadcast_to(b, a.shape)
    return np.abs(a - b).mean(axis=1) / np.maximum(np.abs(b).mean(axis=1), 1e-9)


def saved(thing, path):
    save(thing, path)
    return load(path)


# -- the warp and the microfacets -----------------------------------------------------------


def test_warp_is_mitsubas(llvm_variant):
    """Random densities over two parameters, some with a row of zeros."""
    mi, rng = llvm_variant, np.random.default_rng(0)
    nodes = np.array([-1.0, 0.5]), np.array([0.0, 0.3, 1.0])
    density = rng.random((2, 3, 9, 7)).astype(np.float32)
    density[:, 1, 4] = 0
    theirs = mi.MarginalContinuous2D2(density, [list(axis) for axis in nodes])
    ours = Warp(density.astype(float).reshape(6, 9, 7))
    u = rng.random((2000, 2))

    params = rng.uniform(-1, 0.5, 2000), rng.uniform(0, 1, 2000)
    point = mi.Point2f(u.T.astype(np.float32))
    inverted, _ = theirs.invert(point, [mi.Float(x.astype(np.float32)) for x in params])
    np.testing.assert_allclose(
        ours.invert(u, find_slices(nodes, params)), np.array(inverted).T, atol=2e-5
    )
    for at, (x, y) in enumerate((x, y) for x in nodes[0] for y in nodes[1]):
        sampled, _ = theirs.sample(point, [mi.Float(float(x)), mi.Float(float(y))])
        np.testing.assert_allclose(ours.sample(at, u), np.array(sampled).T, atol=2e-4)


def test_warp_inverts_itself_and_follows_its_density():
    rng = np.random.default_rng(1)
    warp = Warp(rng.random((1, 6, 5)) ** 4)
    u = rng.random((100_000, 2))
    points = warp.sample(0, u)
    np.testing.assert_allclose(warp.invert(points, [(0, 1.0)]), u, atol=1e-9)
    edges = make_even_grid(9)
    np.testing.assert_allclose(warp.sample(0, edges).min(axis=0), 0, atol=1e-12)
    np.testing.assert_allclose(warp.sample(0, edges).max(axis=0), 1, atol=1e-12)
    # the share of the points in each cell is the mean of its corners
    d = warp.density[0]
    expected = d[1:, 1:] + d[1:, :-1] + d[:-1, 1:] + d[:-1, :-1]
    counts, _, _ = np.histogram2d(points[:, 1], points[:, 0], (5, 4), [[0, 1], [0, 1]])
    expected *= len(u) / expected.sum()
    chi_squared = ((counts - expected) ** 2 / expected).sum()
    assert chi_squared < 43.8  # 19 degrees of freedom: once in a thousand


@pytest.mark.parametrize(
    ("alpha_x", "alpha_y", "n_phi"), [(0.1, 0.1, 1), (0.3, 0.3, 1), (0.2, 0.4, 64)]
)
def test_find_normals_finds_the_microfacets(alpha_x, alpha_y, n_phi):
    """f(w, w) of a GGX surface that masks what it shadows: D and σ are known in closed form."""
    hemisphere = Hemisphere(np.linspace(0, 1, 256) ** 2 * np.pi / 2, n_phi)
    x, y, z = np.moveaxis(hemisphere.directions, -1, 0)
    D = 1 / (np.pi * alpha_x * alpha_y * ((x / alpha_x) ** 2 + (y / alpha_y) ** 2 + z**2) ** 2)
    sigma = (z + np.sqrt(z**2 + (alpha_x * x) ** 2 + (alpha_y * y) ** 2)) / 2
    found = find_normal_distribution(0.3 * D / (4 * np.maximum(z, 1e-9) * sigma), hemisphere)
    near = hemisphere.theta < np.radians(80)
    np.testing.assert_allclose(found[:, near], D[:, near], rtol=5e-3)
    np.testing.assert_allclose(hemisphere.projected_area(found), sigma, atol=1e-3)


# -- reading ----------------------------------------------------------------------------------


@pytest.mark.parametrize("name", DATABASE)
def test_the_database_is_looked_up_as_mitsuba_does(llvm_variant, measured_data, name):
    path = measured_data / "rgl" / f"{name}_rgb.bsdf"
    material = load(path)
    wi, wo = draw_direction_pairs(50_000, seed=3)
    # `eval` clamps what `measured` leaves negative
    theirs = np.maximum(Rendered(path).eval(wi, wo), 0)
    ours = material.eval(wi, wo)
    bright = theirs.mean(axis=1) > 1e-3 * theirs.mean(axis=1).max()
    differences = relative(ours, theirs)
    # single precision there: more where values cross 0, and where the warp has few normals
    assert np.median(differences) < 1e-6
    assert np.quantile(differences[bright], 0.999) < 1e-3
    assert np.abs((ours - theirs) * wo[:, 2:]).max() < 1e-4 * (theirs * wo[:, 2:]).max()

    # at its own points it has the stored values, where no others belong to the same pair
    samples = material.samples
    half = samples.wi + samples.wo
    off_mirror = half[:, 2] < (1 - 1e-9) * np.linalg.norm(half, axis=1)
    samples = samples.at(samples.valid & off_mirror)
    differences = relative(material.eval(samples.wi, samples.wo), np.maximum(samples.values, 0))
    assert np.quantile(differences, 0.99) < 1e-6
    assert differences.max() < 1e-3
    assert np.degrees(np.arccos(samples.wi[:, 2].min())) > 78
    assert material.info["description"]
    assert not material.anisotropic
    assert (material.values[material.samples.valid] < 0).any() == name.startswith("c")
    pickle.loads(pickle.dumps(material)).eval(wi[:9], wo[:9])


def variations():
    """Files that the writer does not make, with the change that makes them."""
    rng = np.random.default_rng(0)

    def without_jacobian(fields):
        fields["jacobian"][:] = 0

    def noisy(fields):
        for name in ("ndf", "vndf", "rgb"):
            fields[name] *= rng.uniform(0.5, 1, fields[name].shape).astype(np.float32)

    return {f.__name__: f for f in (without_jacobian, noisy)}


@pytest.mark.parametrize("change", variations())
def test_variations_are_looked_up_as_mitsuba_does(llvm_variant, tmp_path, small_tables, change):
    save(bk.models()["ggx"](), tmp_path / "plain.bsdf")
    fields = unpacked((tmp_path / "plain.bsdf").read_bytes())
    variations()[change](fields)
    path = tmp_path / "changed.bsdf"
    path.write_bytes(packed(fields))
    wi, wo = draw_direction_pairs(5000, seed=4)
    theirs = Rendered(path).eval(wi, wo)
    assert np.quantile(relative(load(path).eval(wi, wo), theirs), 0.999) < 1e-3


def turned(brdf, angle):
    """`brdf` on a surface turned about its normal."""
    c, s = np.cos(angle), np.sin(angle)
    matrix = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    return SimpleNamespace(eval=lambda wi, wo: brdf.eval(wi @ matrix, wo @ matrix))


def lopsided(wi, wo):
    return 0.2 + 0.1 * (wi + wo)[:, :1] * [1, 0.9, 0.8]


WARD = {"alpha_u": 0.2, "alpha_v": 0.6}
SYMMETRIES = {
    "isotropic": (lambda: bk.models()["ward"](), 0),
    "two planes": (lambda: bk.models()["ward"](**WARD), 1),
    "half turn": (lambda: turned(bk.models()["ward"](**WARD), 0.4), 2),
    "none": (lambda: SimpleNamespace(eval=lopsided), 4),
}


@pytest.mark.parametrize("kind", SYMMETRIES)
def test_every_symmetry_is_found_written_and_looked_up(llvm_variant, tmp_path, small_tables, kind):
    make, quarters = SYMMETRIES[kind]
    brdf = make()
    assert encoding.detect_symmetry(brdf.eval) == quarters
    material = saved(brdf, tmp_path / "surface.bsdf")
    assert material.anisotropic == (quarters > 0)
    wi, wo = draw_direction_pairs(5000, seed=4)
    theirs = Rendered(tmp_path / "surface.bsdf").eval(wi, wo)
    assert np.quantile(relative(material.eval(wi, wo), theirs), 0.999) < 1e-3
    assert np.median(relative(theirs, brdf.eval(wi, wo))) < 0.05  # of so small a table


def test_mitsubas_container_is_read_and_ours_is_read_by_it(tmp_path, capsys):
    import mitsuba as mi

    mi.set_variant("scalar_rgb")
    from mitsuba.python import tensor_io

    rng = np.random.default_rng(0)
    types = [f"{kind}{size}" for kind in "ui" for size in (1, 2, 4, 8)] + ["f2", "f4", "f8"]
    fields = {f"of_{t}": rng.integers(0, 99, (2, 3, i + 1)).astype(t) for i, t in enumerate(types)}
    theirs, ours = tmp_path / "theirs", tmp_path / "ours"
    tensor_io.write(str(theirs), **fields)
    ours.write_bytes(packed(fields))
    for found in (unpacked(theirs.read_bytes()), tensor_io.read(str(ours))):
        assert list(found) == list(fields)
        for name, array in fields.items():
            np.testing.assert_array_equal(found[name], array)
            assert found[name].dtype == array.dtype
    assert ours.read_bytes() == theirs.read_bytes()


def changed(**changes):
    """The small file with fields replaced, or left out where None."""
    fields = unpacked(rgl()) | {n: np.asarray(a) for n, a in changes.items() if a is not None}
    return packed({n: a for n, a in fields.items() if n not in changes or changes[n] is not None})


def field(name, **at):
    """A field of the small file with an entry replaced."""
    array = unpacked(rgl())[name]
    for index, value in at.items():
        array.flat[int(index.lstrip("_"))] = value
    return array


def header(old, new):
    data = rgl()
    assert old in data
    return data.replace(old, new, 1)


SPECTRAL = {"rgb": None, "spectra": field("rgb")}
TRAPS = {
    "header only": (rgl()[:18], "ends within its list of fields, at byte 18"),
    "cut in a name": (rgl()[:22], "ends within its list of fields, at byte 22"),
    "cut behind a field": (rgl()[:60], "field 'phi_i', 1 numbers .* not within the 60 bytes"),
    "cut in the data": (rgl()[:-9], "field 'description', .* not within .*cut short"),
    "other version": (header(b"file\0\1\0", b"file\0\2\0"), "no tensor file of version 1.0"),
    "many fields": (header(b"\1\0\x09\0\0\0", b"\1\0\xff\xff\xff\xff"), "'' has 0 dimensions"),
    "type": (header(b"phi_i\1\0\x0a", b"phi_i\1\0\x0c"), "'phi_i' has the unknown type 12"),
    "type 0": (header(b"phi_i\1\0\x0a", b"phi_i\1\0\0"), "'phi_i' has the unknown type 0"),
    "no dimension": (header(b"phi_i\1\0", b"phi_i\0\0"), "'phi_i' has 0 dimensions"),
    "huge": (header(b"ndf\2\0\x0a", b"ndf\2\0\x0b"), "'ndf' has the type float64"),
    "twice": (header(b"sigma", b"phi_i"), "has the field 'phi_i' twice"),
    "no theta_i": (changed(theta_i=None), "no field 'theta_i'"),
    "no rgb": (changed(rgb=None), "no field 'rgb'"),
    "no luminance": (changed(luminance=None), "no field 'luminance'"),
    "no jacobian": (changed(jacobian=None), "no field 'jacobian'"),
    "no spectra": (changed(wavelengths=np.float32([500, 600, 700])), "no field 'spectra'"),
    "double": (changed(ndf=field("ndf").astype(float)), "'ndf' has the type float64"),
    "four channels": (
        changed(rgb=np.ones((1, 3, 4, 5, 5), np.float32)),
        "1×3×4×5×5, where 1×3×3×5×5",
    ),
    "other grid": (changed(rgb=np.ones((1, 3, 3, 5, 4), np.float32)), "1×3×3×5×4, where"),
    "one node": (changed(sigma=np.ones((1, 8), np.float32)), "'sigma' is 1×8, where 2×8"),
    "flat": (changed(vndf=np.ones((1, 3, 25), np.float32)), "'vndf' is 1×3×25, where"),
    "not a number": (changed(rgb=field("rgb", _7=np.nan)), "'rgb' has 1 values that are not"),
    "infinite": (changed(luminance=field("luminance", _7=np.inf)), "'luminance' has 1 values"),
    "theta_i falls": (changed(theta_i=np.float32([0, 1, 0.5])), "'theta_i' should increase"),
    "degrees": (changed(theta_i=np.float32([0, 45, 90])), "'theta_i' should .* at most 90°"),
    "phi_i twice": (
        changed(**{n: np.repeat(field(n), 2, 0) for n in ("phi_i", "vndf", "luminance", "rgb")}),
        "'phi_i' should increase",
    ),
    "negative D": (changed(ndf=field("ndf", _3=-1)), "'ndf' should not be negative"),
    "no area": (changed(sigma=field("sigma", _3=0)), "'sigma' should be positive"),
    "no normals": (changed(vndf=0 * field("vndf")), "'vndf' should .* whole incidence"),
    "all dark": (changed(luminance=0 * field("luminance")), "no point of its grid"),
    "no wavelengths": (
        changed(wavelengths=np.float32([]), **SPECTRAL),
        "'wavelengths' is empty",
    ),
    "wavelengths fall": (
        changed(wavelengths=np.float32([500, 400, 600]), **SPECTRAL),
        "'wavelengths' should increase",
    ),
    "other wavelengths": (
        changed(wavelengths=np.float32([500, 600]), **SPECTRAL),
        "'spectra' is 1×3×3×5×5, where 1×3×2×5×5",
    ),
}


@pytest.mark.parametrize("trap", TRAPS)
def test_traps(tmp_path, trap):
    data, match = TRAPS[trap]
    path = tmp_path / "grey.bsdf"
    path.write_bytes(data)
    with pytest.raises(BrdfkitError, match=match) as caught:
        load(path)
    message = str(caught.value)
    assert message.startswith(f"{path}: ")
    assert message.endswith(".")
    assert len(message) < len(str(path)) + 250


def test_a_size_that_the_file_does_not_have_is_not_allocated(tmp_path):
    """4 million terabytes, by eight dimensions whose product no machine word holds."""
    fields = unpacked(rgl())
    data = packed(fields | {"ndf": fields["ndf"].reshape(2, 1, 1, 1, 1, 1, 2, 4)})
    shape = np.array([2, 1, 1, 1, 1, 1, 2, 4], "<u8").tobytes()
    assert shape in data
    path = tmp_path / "grey.bsdf"
    path.write_bytes(data.replace(shape, np.full(8, 2**63, "<u8").tobytes()))
    with pytest.raises(BrdfkitError, match=r"'ndf', 92233.* is not within"):
        load(path)


# -- rendering --------------------------------------------------------------------------------


def below_zero(fields):
    """As colours out of gamut are, and an instrument's zero."""
    fields["rgb"] -= fields["rgb"].mean(axis=(2, 3, 4), keepdims=True) * np.float32(0.5)


def partly_dark(fields):
    """No luminance for one incidence, and for a third of the others', though they have values."""
    fields["luminance"][:, 2] = 0
    fields["luminance"][..., :5, :] = 0


def two_azimuths(fields):
    """An isotropic file may have two phi_i."""
    fields["phi_i"] = np.float32([-1, 2])
    for name in ("vndf", "luminance", "rgb"):
        fields[name] = np.concatenate([fields[name], fields[name] ** 2 + 0.1])


def one_incidence(fields):
    for name in ("vndf", "luminance", "rgb"):
        fields[name] = fields[name][:, 3:4]
    fields["theta_i"] = np.float32([0.7])


CHANGES = {**variations(), **{f.__name__: f for f in (below_zero, partly_dark, two_azimuths)}}
CHANGES["one_incidence"] = one_incidence
STATISTICS = ("coverage", "weights", "finite")


def rendered(kind):
    """A small material, by its symmetry or how its file was changed."""
    if kind in SYMMETRIES:
        make, _ = SYMMETRIES[kind]
        return adaptive(rgl_file(make()))
    fields = unpacked(rgl_file(bk.models()["ggx"]()))
    CHANGES[kind](fields)
    return adaptive(packed(fields))


@pytest.mark.parametrize("kind", [*SYMMETRIES, *CHANGES])
def test_what_is_rendered_is_what_eval_says(llvm_variant, kind):
    material = rendered(kind)
    subject = Subject(material)
    assert "MeasuredAdaptive" in str(subject.bsdf)
    for wi, wo in (pairs(degrees=89.5), draw_direction_pairs(20_000, seed=6, max_degrees=89.99)):
        expected = material.eval(wi, wo) * wo[:, 2:]
        found = subject.eval_plugin(wi, wo)
        assert np.median(relative(found, expected)) < 2e-6
        assert np.quantile(relative(found, expected), 0.999) < 1e-3
        assert np.abs(found - expected).max() < 1e-4 * expected.max()


@pytest.mark.parametrize("kind", ["isotropic", "half turn", "partly_dark", "one_incidence"])
def test_it_is_sampled_as_it_says(llvm_variant, kind):
    """Where the file has no luminance, too."""
    chi_squared = ("chi squared",) if kind in ("half turn", "partly_dark") else ()
    report = bk.check(rendered(kind), only=STATISTICS + chi_squared)
    assert report, str(report)


@pytest.mark.parametrize("kind", ["two planes", "half turn"])
@pytest.mark.parametrize("x", [1, -1])
def test_a_plane_of_symmetry_is_no_edge(llvm_variant, kind, x):
    """There phi_i is π, or -π: from single precision both may come, the file has one."""
    material = rendered(kind)
    _, wo = pairs(1000)
    wi = np.tile([0.6 * x, 0, 0.8], (1000, 1))
    found = Subject(material).eval_plugin(wi, wo) / wo[:, 2:]
    assert np.quantile(relative(found, material.eval(wi, wo)), 0.99) < 1e-3


def test_spectra_are_rendered(variant):
    material = adaptive(rgl_file(spectral()))
    wi, wo = pairs(5000, degrees=89.5)
    for label in ("llvm_ad_spectral", "llvm_ad_rgb"):
        variant(label)
        subject = Subject(material)
        found, expected = subject.eval_plugin(wi, wo), subject.eval_expected(wi, wo) * wo[:, 2:]
        assert np.quantile(relative(found, expected), 0.999) < 1e-4
        assert bk.check(material, only=["coverage"])
    assert "MeasuredAdaptive" in str(subject.bsdf)  # as the colours of the spectra


@pytest.mark.parametrize("name", DATABASE)
def test_the_database_is_rendered_as_by_mitsuba(llvm_variant, measured_data, name):
    """And the weights of samples vary no more: E[w²] ≤ E'[w²] / 0.98 with a fiftieth of cosine."""
    path = measured_data / "rgl" / f"{name}_rgb.bsdf"
    ours, theirs = Subject(load(path)), Rendered(path)
    wi, wo = pairs(50_000, degrees=89.5)
    grazing = np.minimum(wi[:, 2], wo[:, 2]) < np.cos(np.radians(80))
    expected = np.maximum(theirs.eval_plugin(wi, wo), 0)
    differences = relative(ours.eval_plugin(wi, wo), expected)
    bright = expected.mean(axis=1) > 1e-3 * expected.mean(axis=1).max()
    for where in (grazing, ~grazing):
        assert np.median(differences[where]) < 1e-6
        assert np.quantile(differences[where], 0.95) < 1e-4
        assert differences[where & bright].max() < 1e-3
    own, others = (compute_weight_spreads(subject, 100_000) for subject in (ours, theirs))
    for spread, other in zip(own, others, strict=True):
        assert 1 + spread**2 < (1 + other**2) / 0.98 + 1e-3


# -- writing ----------------------------------------------------------------------------------


def spectral():
    """A table whose spectrum changes with the angle; its wavelengths in no order."""
    theta_h = np.linspace(0, 1, 30)[:, None, None, None]
    values = 0.1 + 0.3 * np.exp(-8 * theta_h) * np.array([0.5, 1.0, 0.2, 0.8])
    channels = ("650nm", "450nm", "555.5nm", "380nm")
    return Measured.from_table(
        np.broadcast_to(values, (30, 2, 4, 4)), channels=channels, name="a spectrum"
    )


def fit():
    model = bk.models()["ward"](alpha_u=0.15, specular_reflectance=[0.3, 0.2, 0.1])
    return Fit(model, "paint", "log", 0.1, 100, 10, 0.5, "made up")


SOURCES = {
    "ggx": lambda: bk.models()["ggx"](alpha_u=0.05),
    "fit of ward": fit,
    "anisotropic": lambda: bk.models()["ggx"](alpha_u=0.15, alpha_v=0.5),
    "dusty_gold": lambda: load("dusty_gold"),
    "red_plastic": lambda: load("red_plastic"),
}


@pytest.fixture(scope="module")
def write_once(mi, tmp_path_factory):
    """A function that returns a source and its file, which it writes once: that takes a second."""
    folder = tmp_path_factory.mktemp("written")

    @cache
    def write(name):
        source, path = SOURCES[name](), folder / f"{name}.bsdf"
        save(source, path)
        return source, path

    return write


@pytest.mark.parametrize("name", SOURCES)
def test_mitsuba_renders_what_was_written(llvm_variant, write_once, name):
    source, path = write_once(name)
    material, rendered = load(path), Rendered(path, source)

    wi, wo = pairs()
    theirs, expected = rendered.eval(wi, wo), source.eval(wi, wo)
    assert np.median(relative(theirs, expected)) < 0.0025
    assert np.quantile(relative(theirs, expected), 0.95) < 0.01
    assert theirs.min() >= 0
    assert np.quantile(relative(material.eval(wi, wo), theirs), 0.999) < 1e-3
    # at the file's own points it is the source
    rows = np.flatnonzero(material.samples.valid)[::97]
    wi, wo = material.samples.wi[rows], material.samples.wo[rows]
    assert relative(material.values[rows], source.eval(wi, wo)).max() < 1e-4

    for _degrees, wi in list_incidences():
        si = rendered.make_interaction(np.tile(wi, (200_000, 1)))
        _, weight = rendered.bsdf.sample(
            llvm_variant.BSDFContext(), si, *draw_uniform_numbers(200_000, seed=1)
        )
        weight = np.array(weight, float).mean(axis=0)
        assert weight.mean() == pytest.approx(bk.albedo(source, wi).mean(), rel=0.01)
        assert weight.std() < 0.15 * weight.mean()


@pytest.mark.parametrize("name", ["blasted_gold", "plaster", "satin_plastic"])
def test_a_noisy_table_is_kept_between_its_cells_too(tmp_path, name):
    """3 to 5 % of noise in each cell, linear between them: the file's nodes are others. Read by
    brdfkit, which the test above holds against Mitsuba."""
    source = load(name)
    wi, wo = pairs()
    differences = relative(
        saved(source, tmp_path / "written.bsdf").eval(wi, wo), source.eval(wi, wo)
    )
    assert np.median(differences) < 0.005
    assert np.quantile(differences, 0.95) < 0.04


@pytest.mark.parametrize("name", ["ggx", "anisotropic", "red_plastic"])
def test_mitsuba_samples_what_was_written(llvm_variant, write_once, monkeypatch, name):
    monkeypatch.setattr(checks.sampling, "SUBCELLS", (24, 96))
    passed, figure = checks.sampling.check_chi_squared(Rendered(write_once(name)[1]))
    assert passed, figure


def test_spectra(variant, tmp_path):
    """In a spectral variant Mitsuba has the spectra, and they are the colours that are read."""
    source, path = spectral(), tmp_path / "spectrum.bsdf"
    material = saved(source, path)
    assert material.channels == ("380nm", "450nm", "555.5nm", "650nm")
    wi, wo = pairs(5000)
    ordered = source.eval(wi, wo)[:, [3, 1, 2, 0]]
    assert np.median(relative(material.eval(wi, wo), ordered)) < 0.0025
    assert np.median(relative(material.rgb.eval(wi, wo), source.rgb.eval(wi, wo))) < 0.0025

    mi = variant("llvm_ad_spectral") or __import__("mitsuba")
    rendered = Rendered(path)
    si = rendered.make_interaction(wi)
    si.wavelengths = mi.Spectrum(380, 415, 450, 650)
    values = rendered.bsdf.eval(mi.BSDFContext(), si, mi.Vector3f(wo.T.astype(np.float32)))
    values = np.array(values).T / wo[:, 2:]
    between = ordered[:, :2].mean(axis=1, keepdims=True)
    expected = np.concatenate([ordered[:, :1], between, ordered[:, [1, 3]]], axis=1)
    assert np.median(relative(values, expected)) < 0.0025
    variant("llvm_ad_rgb")
    with pytest.raises(RuntimeError, match="spectral variant"):
        Rendered(path)
    save(source.rgb, path)
    assert np.median(relative(Rendered(path).eval(wi, wo), source.rgb.eval(wi, wo))) < 0.0025


def test_achromatic_black_and_rewritten(llvm_variant, tmp_path, monkeypatch):
    monkeypatch.setattr(encoding, "ISOTROPIC", Resolution(0, 16, 1, 64, 48))
    wi, wo = pairs(1000)
    for reflectance in (0.3, 0.0):
        grey = Measured.from_table(np.full((4, 4, 8, 1), reflectance), channels=("Y",))
        back = saved(grey, tmp_path / "grey.bsdf")
        assert back.channels == ("R", "G", "B")
        np.testing.assert_allclose(back.eval(wi, wo), np.full((1000, 3), reflectance), rtol=0.05)
        again = saved(back, tmp_path / "again.bsdf")
        rewritten = Rendered(tmp_path / "again.bsdf").eval(wi, wo)
        np.testing.assert_allclose(rewritten, again.eval(wi, wo), rtol=1e-3, atol=1e-9)


def test_equal_bytes_and_a_description(tmp_path, small_tables):
    model = bk.models()["ward"](alpha_u=0.3)
    first, second = tmp_path / "a.bsdf", tmp_path / "b.bsdf"
    for path in (first, second):
        save(model, path)
    assert first.read_bytes() == second.read_bytes()
    assert load(first).info["description"].startswith("ward(diffuse_reflectance=0.4")
    assert load(first).info["description"].endswith(f"written by brdfkit {bk.__version__}")
    described = Measured.from_table(np.ones((2, 2, 4, 3)), info={"description": "Paper, für uns"})
    assert saved(described, first).info["description"].startswith("Paper, für uns; written")


def test_refuses_what_it_cannot_hold(tmp_path, small_tables):
    nowhere = Measured.from_table(np.ones((2, 2, 4, 2)), channels=("left", "right"))
    endless = SimpleNamespace(eval=lambda wi, wo: np.full((len(wi), 3), np.inf))
    many = SimpleNamespace(eval=lambda wi, wo: np.full((len(wi), 31), 0.1))
    refused = {"left, right": nowhere, "not finite at theta_i": endless, "31 channels": many}
    for match, thing in (refused | {"a dict has no BRDF": {}}).items():
        with pytest.raises(BrdfkitError, match=f"x.bsdf: .*{match}"):
            save(thing, tmp_path / "x.bsdf")
    assert not any(tmp_path.iterdir())
