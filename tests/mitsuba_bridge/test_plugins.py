"""Plugins of every kind: a file is there, so Mitsuba knows it, in every variant and however it is
asked; a user's own as brdfkit's. And every plugin × what its kind must fulfil."""

import functools
import math
import textwrap

import drjit as dr
import numpy as np
import pytest

import brdfkit as bk
from brdfkit.checks.plugin_subject import make_example
from brdfkit.checks.registry import checks
from brdfkit.core.discovery import plugin_files
from brdfkit.core.discovery.plugin_files import KINDS, MODELS, find_plugins
from brdfkit.core.discovery.plugin_pages import read_page

quick = functools.partial(pytest.param, marks=pytest.mark.quick)
VARIANTS = (quick("llvm_ad_rgb"), "llvm_ad_mono", "llvm_ad_spectral_polarized", "scalar_rgb")
OTHERS = {name: kind for kind in KINDS if kind != MODELS for name in find_plugins(kind)}


# brdfkit's own


@pytest.mark.quick
def test_every_plugin_has_a_page(no_user_plugins):
    for kind in KINDS:
        for name, source in find_plugins(kind).items():
            found = read_page(source)
            assert found.title, name
            assert found.sentence.endswith("."), name


@pytest.mark.parametrize("name", OTHERS)
@pytest.mark.parametrize("chosen", VARIANTS)
def test_loads_in_every_variant(name, chosen, variant):
    import mitsuba as mi

    if (OTHERS[name], chosen) == ("volumes", "scalar_rgb"):
        pytest.skip("volumes are not registered there, see `register_new_plugins`")
    variant(chosen)
    base, _ = KINDS[OTHERS[name]]
    plugin = mi.load_dict(make_example(name))
    assert isinstance(plugin, getattr(mi, base))
    assert type(plugin).__name__ in str(plugin)


@pytest.mark.parametrize("chosen", [quick("llvm_ad_rgb"), "llvm_ad_mono", "llvm_ad_spectral"])
@pytest.mark.parametrize(
    ("name", "check"), [(name, c) for name, kind in OTHERS.items() for c in checks[kind]]
)
def test_passes_the_checks(name, check, chosen, variant):
    variant(chosen)
    report = bk.check(name, only=[check])
    assert report, str(report)


def settings(name):
    """The declared parameters of a plugin."""
    return plugin_files.import_plugin(find_plugins(OTHERS[name])[name]).PARAMETERS


BOUNDED = [(n, p) for n in OTHERS for p, setting in settings(n).items() if setting.bounds]


@pytest.mark.quick
@pytest.mark.parametrize(("name", "parameter"), BOUNDED)
def test_what_is_out_of_bounds_is_refused_by_name(name, parameter, llvm_variant):
    mi = llvm_variant
    low, high = settings(name)[parameter].bounds
    for wrong in (low - 1, high + 1, math.nan, "many"):
        if wrong in (math.inf, -math.inf):
            continue
        with pytest.raises(RuntimeError) as error:
            mi.load_dict(make_example(name, **{parameter: wrong}))
        assert f"{name}: {parameter} = {wrong}" in str(error.value).splitlines()[-1]


@pytest.mark.quick
@pytest.mark.parametrize("name", OTHERS)
def test_a_misspelt_parameter_is_reported(name, llvm_variant):
    with pytest.raises(RuntimeError, match="misspelt"):
        llvm_variant.load_dict({**make_example(name), "misspelt": 1.0})


# A user's own, one of each kind


def users(base, body, name):
    """The text of a plugin file."""
    return f'''
"""{name.capitalize()}: a plugin of a user's."""
import mitsuba as mi
import drjit as dr

def define(mi):
    class Users(mi.{base}):
        def __init__(self, props):
            super().__init__(props)
{textwrap.indent(textwrap.dedent(body), " " * 12)}
        def to_string(self):
            return "Users[]"
    return Users
'''


FACTORY = '''
"""Round: a sphere of radius `r`."""

def define(mi):
    def make(props):
        rest = {k: props[k] for k in props.keys() if k != "r"}
        return mi.load_dict({"type": "sphere", "radius": props.get("r", 2.0), **rest})
    return make
'''
CAMERA = '''
"""Eye: a camera of 30 degrees."""

def define(mi):
    return lambda props: mi.load_dict({"type": "perspective", "fov": 30.0})
'''
BODIES = {
    "bsdfs": ("BSDF", "self.m_components = [mi.BSDFFlags.Null]\nself.m_flags = mi.BSDFFlags.Null"),
    "emitters": ("Emitter", "self.m_flags = mi.EmitterFlags.Infinite"),
    "integrators": ("SamplingIntegrator", "pass"),
    "phase": ("PhaseFunction", "self.m_flags = mi.PhaseFunctionFlags.Isotropic"),
    "textures": ("Texture", "pass"),
    "volumes": ("Volume", "pass"),
}
FILES = {kind: users(*body, f"users {kind}") for kind, body in BODIES.items()}
FILES |= {"shapes": FACTORY, "sensors": CAMERA}


@pytest.fixture
def folder(tmp_path, no_user_plugins):
    """A folder of plugins of every kind, laid out as brdfkit's own."""
    for kind, text in FILES.items():
        (tmp_path / kind).mkdir()
        (tmp_path / kind / f"users_{kind}.py").write_text(text)
    return tmp_path


@pytest.mark.quick
def test_every_kind_has_a_users_plugin():
    assert FILES.keys() == KINDS.keys()


@pytest.mark.quick
@pytest.mark.parametrize("chosen", ["llvm_ad_rgb", "llvm_ad_spectral", "scalar_rgb"])
@pytest.mark.parametrize("before", [True, False])
def test_a_users_folder_of_every_kind(folder, variant, chosen, before):
    """Before and after the variant is set; in dictionaries and files, by worker threads, too."""
    import mitsuba as mi

    variant("llvm_ad_mono")
    if before:
        loaded = bk.load_plugins(folder)
    variant(chosen)
    if not before:
        loaded = bk.load_plugins(folder)
    assert loaded == {f"users_{kind}": kind for kind in KINDS}
    for kind, (base, _) in KINDS.items():
        if (kind, chosen) != ("volumes", "scalar_rgb"):  # see `register_new_plugins`
            assert isinstance(mi.load_dict({"type": f"users_{kind}"}), getattr(mi, base))
    (folder / "scene.xml").write_text(
        '<scene version="3.0.0"><integrator type="users_integrators"/>'
        '<shape type="users_shapes"><bsdf type="users_bsdfs"/><float name="r" value="3"/></shape>'
        '<shape type="cube"><bsdf type="diffuse">'
        '<texture name="reflectance" type="users_textures"/></bsdf></shape>'
        '<emitter type="users_emitters"/><sensor type="users_sensors"/></scene>'
    )
    for parallel in (True, False):
        scene = mi.load_file(str(folder / "scene.xml"), parallel=parallel)
        assert "Users" in str(scene.environment())
        assert len(scene.shapes()) == 2


@pytest.mark.quick
def test_a_new_kind_is_one_line(tmp_path, no_user_plugins, variant, monkeypatch):
    import mitsuba as mi

    variant("llvm_ad_rgb")
    monkeypatch.setitem(KINDS, "media", ("Medium", "register_medium"))
    (tmp_path / "media").mkdir()
    (tmp_path / "media" / "users_fog.py").write_text(users("Medium", "pass", "fog"))
    assert bk.load_plugins(tmp_path) == {"users_fog": "media"}
    assert isinstance(mi.load_dict({"type": "users_fog"}), mi.Medium)


MODEL = """
from brdfkit.model import Model, weight
from brdfkit.model.lobes import lambertian

class Felt(Model):
    diffuse_reflectance = weight(0.3, "k_d")

    def lobes(self):
        return (lambertian(),)
"""


@pytest.mark.quick
def test_a_model_may_lie_anywhere(tmp_path, no_user_plugins):
    (tmp_path / "users_felt.py").write_text(MODEL)
    assert bk.load_plugins(tmp_path / "users_felt.py") == {"users_felt": "bsdfs"}
    assert "users_felt" in bk.models()


@pytest.mark.quick
@pytest.mark.parametrize(
    ("path", "text", "said"),
    [
        ("users_lamp.py", FILES["emitters"], r"put it into one of bsdfs/, emitters/"),
        ("emitters/users_lamp.py", "x = 1", r"has no function define\(mi\)"),
        ("emitters/users_lamp.py", "1 / 0", "division by zero"),
        ("emitters/users_lamp.py", "raise Exception", "cannot be imported: Exception"),
        ("emitters/users_lamp.py", "raise SystemExit(3)", "ends the program"),
        ("emitters/users_lamp.py", "raise BaseException('no')", "cannot be imported: no"),
        ("emiters/users_lamp.py", FILES["emitters"], r"emiters is no kind .* rename it emitters/"),
        ("emitters/schlick.py", FILES["emitters"], "brdfkit has a plugin 'schlick'"),
        ("emitters/envmap.py", FILES["emitters"], "Mitsuba has a plugin 'envmap'"),
    ],
)
def test_what_is_no_plugin_is_refused(tmp_path, no_user_plugins, path, text, said):
    file = tmp_path / path
    file.parent.mkdir(exist_ok=True)
    file.write_text(text)
    other = tmp_path / "phase" / "users_fog.py"
    other.parent.mkdir()
    other.write_text(FILES["phase"])
    with pytest.raises(bk.BrdfkitError, match=said):
        bk.load_plugins(tmp_path)
    assert not plugin_files._users  # nor any of the others


@pytest.mark.quick
def test_a_folder_may_be_loaded_by_another_path(folder):
    first = bk.load_plugins(folder)
    assert bk.load_plugins(folder / ".." / folder.name) == first
    link = folder.with_name(f"{folder.name} again")
    link.symlink_to(folder)
    assert bk.load_plugins(link) == first


@pytest.mark.quick
@pytest.mark.parametrize(
    ("line", "said"),
    [("pass", "returns None; it should"), ("raise ValueError('boom')", "raises ValueError: boom")],
)
def test_what_defines_nothing_is_named(tmp_path, no_user_plugins, variant, line, said):
    import mitsuba as mi

    variant("llvm_ad_rgb")
    file = tmp_path / "textures" / "users_nothing.py"
    file.parent.mkdir()
    file.write_text(f"def define(mi):\n    {line}\n")
    bk.load_plugins(file)
    with pytest.raises(RuntimeError, match=rf"users_nothing\.py: define\(mi\) {said}"):
        mi.load_dict({"type": "users_nothing"})
    report = bk.check("users_nothing")
    assert [finding.check for finding in report.findings] == ["loads"]
    assert not report


def test_a_bsdf_that_is_no_model_is_checked(variant):
    variant("llvm_ad_rgb")
    assert bk.check("measured_table", only=["weights", "finite", "plugin is formula"])


# What the checks are for, done wrong


PHASE = '''
"""Even: light goes anywhere."""
import drjit as dr

def define(mi):
    class Even(mi.PhaseFunction):
        def __init__(self, props):
            super().__init__(props)
            self.m_flags = mi.PhaseFunctionFlags.Isotropic

        def sample(self, ctx, interaction, sample1, sample2, active=True):
            wo = mi.warp.square_to_uniform_{shape}(sample2)
            return wo, mi.Spectrum({weight}), mi.Float({sampled} * dr.inv_four_pi)

        def eval_pdf(self, ctx, interaction, wo, active=True):
            pdf = mi.Float({density} * dr.inv_four_pi)
            return mi.Spectrum({value} * pdf), pdf

        def to_string(self):
            return "Even[]"
    return Even
'''
RIGHT = {"shape": "sphere", "weight": 1.0, "sampled": 1.0, "density": 1.0, "value": 1.0}


@pytest.mark.quick
@pytest.mark.parametrize(
    ("wrong", "failed"),
    [
        ({}, set()),
        ({"density": 1.05, "sampled": 1.05}, {"chi squared", "normalisation"}),
        ({"weight": 2.0, "value": 2.0}, {"normalisation"}),
        ({"weight": "dr.nan"}, {"weights", "mean cosine"}),
        ({"weight": "dr.nan", "value": "dr.nan"}, {"weights", "normalisation", "mean cosine"}),
        ({"sampled": 1.05}, {"weights"}),
        ({"weight": 0.9}, {"weights"}),
        ({"shape": "hemisphere"}, {"chi squared", "mean cosine"}),
    ],
)
def test_the_checks_of_phase_functions_notice(wrong, failed, tmp_path, no_user_plugins, variant):
    variant("llvm_ad_rgb")
    file = tmp_path / "phase" / "users_even.py"
    file.parent.mkdir()
    file.write_text(PHASE.format(**RIGHT | wrong))
    bk.load_plugins(file)
    report = bk.check("users_even")
    assert {f.check for f in report.findings if not f.passed} == failed


@pytest.mark.parametrize(
    ("attribute", "failed"),
    [
        ("pdf_direction", {"chi squared", "normalisation", "weights"}),
        ("eval", {"weights", "mean light"}),
    ],
)
def test_the_checks_of_emitters_notice(attribute, failed, monkeypatch, variant):
    import mitsuba as mi

    variant("llvm_ad_rgb")
    plugin = type(mi.load_dict(make_example("kdtree_envmap")))
    right = getattr(plugin, attribute)
    monkeypatch.setattr(plugin, attribute, lambda *arguments: 1.05 * right(*arguments))
    report = bk.check("kdtree_envmap")
    assert {f.check for f in report.findings if not f.passed} == failed


@pytest.mark.quick
def test_a_check_of_an_integrator_notices(llvm_variant):
    """Half of the steps of a volume that is not even do not give the even one's radiance."""
    grid = llvm_variant.VolumeGrid(np.linspace(0, 4, 8, dtype=np.float32).reshape(8, 1, 1, 1))
    right = {"type": "emission_absorption"}
    assert bk.check(right, only=["reference"])
    uneven = right | {"extinction": {"type": "gridvolume", "grid": grid}}
    assert not bk.check(uneven, only=["reference"])


@pytest.mark.quick
def test_a_plugin_that_raises_has_failed(tmp_path, no_user_plugins, variant):
    variant("llvm_ad_rgb")
    file = tmp_path / "phase" / "users_broken.py"
    file.parent.mkdir()
    file.write_text(PHASE.format(**RIGHT).replace("mi.warp", "mi.wrap"))
    bk.load_plugins(file)
    (finding,) = bk.check("users_broken", only=["weights"]).findings
    assert not finding.passed
    assert finding.figure.startswith("users_broken.py, line 12: ")


@pytest.mark.quick
def test_mean_cosine_of_schlick():
    """Of the file's formula, by quadrature, in double precision."""
    from brdfkit.plugins.phase import schlick

    mu, weight = np.polynomial.legendre.leggauss(200)
    for k in (-0.8, 0.1, 0.5):
        p = np.array(schlick.density(dr.scalar.ArrayXf64(k), dr.scalar.ArrayXf64(mu)))
        mean = 1 / k - (1 - k * k) / (2 * k * k) * np.log((1 + k) / (1 - k))
        assert 2 * np.pi * p @ weight == pytest.approx(1, abs=1e-12)
        assert 2 * np.pi * (p * mu) @ weight == pytest.approx(mean, abs=1e-12)
        u = np.linspace(0, 1, 11)
        turned = np.array(schlick.draw_cosine(k, u))
        below = [2 * np.pi * p[mu < end] @ weight[mu < end] for end in turned]
        assert below == pytest.approx(u, abs=0.02)


@pytest.mark.quick
def test_the_nearest_plugin_is_proposed():
    with pytest.raises(bk.BrdfkitError, match="no plugin 'schlik'; did you mean schlick"):
        bk.check("schlik")
