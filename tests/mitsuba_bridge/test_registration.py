"""The models as Mitsuba plugins: in every variant, in any order of imports, beside the built-in
ones; their parameters as textures and as what an optimiser changes; models of a user's own."""

import math
import os
import subprocess
import sys
from pathlib import Path

import drjit as dr
import numpy as np
import pytest

import brdfkit as bk
from brdfkit.core.discovery import plugin_files
from brdfkit.core.jit import llvm

QUICK = (pytest.param(name, marks=pytest.mark.quick) for name in ("llvm_ad_rgb", "scalar_rgb"))
VARIANTS = (*QUICK, "llvm_ad_mono", "llvm_ad_spectral", "scalar_spectral")
WO_Z = math.sqrt(1 - 0.34)
FELT = """from brdfkit.model.lobes import lambertian
from brdfkit.model import Model, weight


class Felt(Model):
    diffuse_reflectance = weight(0.3, "k_d")

    def lobes(self):
        return (lambertian(),)
"""


def values(model, factor=1.0):
    """Every parameter of a model, times `factor`, within the bounds; none is 0 or on a bound."""
    bounds = {name: parameter.bounds for name, parameter in model.parameters.items()}
    given = {n: min(value or 0.02, 0.8 * bounds[n][1]) for n, value in model().values.items()}
    return {n: float(np.clip(v * factor, *bounds[n])) for n, v in given.items()}


def interaction(mi, u=0.1):
    si = dr.zeros(mi.SurfaceInteraction3f)
    si.wi = mi.Vector3f(0.6, 0.3, 0.7)
    si.wi /= dr.norm(si.wi)
    si.uv = mi.Point2f(u, 0.1)
    si.sh_frame = mi.Frame3f([0, 0, 1])
    return si


def evaluated(mi, bsdf, u=0.1):
    """BRDF times cosine at one pair of directions, as NumPy."""
    wo = mi.Vector3f(-0.5, 0.3, WO_Z)
    return np.array(bsdf.eval(mi.BSDFContext(), interaction(mi, u), wo)).ravel()


# There, wherever Mitsuba is


@pytest.mark.parametrize("name", VARIANTS)
def test_loads_in_every_variant(model, variant, name):
    import mitsuba as mi

    variant(name)
    kind = model.type_name()
    by_dict = mi.load_dict({"type": kind})
    by_xml = mi.load_string(f'<bsdf version="3.0.0" type="{kind}"/>')
    for bsdf in (by_dict, by_xml):
        assert isinstance(bsdf, mi.BSDF)
        assert bsdf.component_count() == len({id(x.sampling) for _, x in model().drawn_lobes()})
    if not mi.is_spectral:  # an interaction without wavelengths has no spectrum
        np.testing.assert_array_equal(evaluated(mi, by_dict), evaluated(mi, by_xml))
        assert (evaluated(mi, by_dict) > 0).all()


LOAD = """
assert isinstance(mi.load_dict({"type": "ward"}), mi.BSDF)
mi.load_string('<scene version="3.0.0"><bsdf type="blinn_phong"/></scene>')
"""


@pytest.mark.parametrize(
    "imports",
    [
        "import brdfkit, mitsuba as mi; mi.set_variant('llvm_ad_rgb')",
        "import mitsuba as mi, brdfkit; mi.set_variant('llvm_ad_rgb')",
        "import mitsuba as mi; mi.set_variant('llvm_ad_rgb'); import brdfkit",
        "import drjit, brdfkit, mitsuba as mi; mi.set_variant('scalar_rgb')",
        "import brdfkit; from mitsuba import set_variant; import mitsuba as mi; "
        "set_variant('scalar_rgb'); mi.set_variant('llvm_ad_rgb')",
        # somebody only asks where Mitsuba is
        "import brdfkit, importlib.util; importlib.util.find_spec('mitsuba'); "
        "import mitsuba as mi; mi.set_variant('llvm_ad_rgb')",
    ],
)
def test_any_order_of_imports(imports):
    usable = llvm.find_llvm_library()
    if usable is None:
        pytest.skip("no LLVM 17 or newer here")
    environment = os.environ | {llvm.VARIABLE: usable}
    command = [sys.executable, "-c", f"{imports}\n{LOAD}"]
    done = subprocess.run(command, capture_output=True, text=True, env=environment, timeout=300)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.quick
def test_no_name_is_a_built_in_plugin():
    import mitsuba as mi

    built_in = {file.stem for file in Path(mi.__file__).with_name("plugins").iterdir()}
    assert {"diffuse", "roughconductor", "path"} < built_in
    kinds = plugin_files.KINDS
    assert not built_in & {name for kind in kinds for name in plugin_files.find_plugins(kind)}


# Parameters


@pytest.mark.parametrize("kind", ["checkerboard", "bitmap"])
def test_every_parameter_may_be_a_texture(model, llvm_variant, kind):
    """In each half of the texture the BSDF is that of the half's value."""
    mi = llvm_variant
    plain = {"type": model.type_name(), **values(model)}
    for name, low in values(model).items():
        high = values(model, 1.2)[name]
        if kind == "checkerboard":
            texture = {"type": kind, "color0": low, "color1": high}
        else:
            pixels = np.array([[[low], [high]]] * 2, np.float32)
            texture = {"type": kind, "bitmap": mi.Bitmap(pixels), "raw": True}
            texture |= {"filter_type": "nearest"}
        textured = mi.load_dict({**plain, name: texture})
        assert mi.has_flag(textured.flags(), mi.BSDFFlags.SpatiallyVarying)
        found = [evaluated(mi, textured, u) for u in (0.1, 0.9)]
        expected = [evaluated(mi, mi.load_dict({**plain, name: v})) for v in (low, high)]
        if kind == "checkerboard" and not np.allclose(found[0], expected[0], rtol=1e-4):
            expected.reverse()
        np.testing.assert_allclose(found, expected, rtol=1e-4, err_msg=name)
        assert low == high or not np.array_equal(*found)


@pytest.mark.quick
def test_every_parameter_can_be_traversed(model, llvm_variant):
    mi = llvm_variant
    bsdf = mi.load_dict({"type": model.type_name(), **values(model)})
    found = mi.traverse(bsdf)
    assert {key.partition(".")[0] for key in found.keys()} == set(model.parameters)  # noqa: SIM118
    for name in model.parameters:
        before = evaluated(mi, bsdf)
        found[f"{name}.value"] = values(model, 1.2)[name]
        found.update()
        assert not np.array_equal(before, evaluated(mi, bsdf)), name


def compiled(mi, bsdf):
    """How many kernels one evaluation compiles (or fetches from the disk: it is new, then)."""
    dr.kernel_history_clear()
    with dr.scoped_set_flag(dr.JitFlag.KernelHistory, True):
        dr.eval(bsdf.eval(mi.BSDFContext(), interaction(mi), mi.Vector3f(0, 0, 1)))
        history = dr.kernel_history([dr.KernelType.JIT])
    assert history
    return sum(not kernel["cache_hit"] or kernel["cache_disk"] for kernel in history)


@pytest.mark.quick
def test_a_new_value_compiles_nothing(model, llvm_variant):
    mi = llvm_variant
    bsdf = mi.load_dict({"type": model.type_name(), **values(model)})
    found = mi.traverse(bsdf)
    counts = []
    for factor in (1.0, 1.05, 1.1, 1.15, 1.2):
        for name, value in values(model, factor).items():
            found[f"{name}.value"] = value
        found.update()
        counts.append(compiled(mi, bsdf))
    assert counts[2:] == [0, 0, 0], counts


@pytest.mark.quick
@pytest.mark.parametrize("name", ["llvm_ad_rgb", "scalar_rgb"])
def test_errors_name_the_parameter(model, variant, name):
    """The last line of what Mitsuba reports says what is wrong, and in which plugin."""
    import mitsuba as mi

    variant(name)
    kind = model.type_name()
    with pytest.raises(RuntimeError) as error:
        mi.load_dict({"type": kind, "no_such_parameter": 1.0})
    assert "no_such_parameter" in str(error.value).splitlines()[-1]
    for parameter, found in model.parameters.items():
        for wrong in (found.bounds[0] - 1, found.bounds[1] + 1, float("nan")):
            if math.isinf(wrong):
                continue
            with pytest.raises(RuntimeError) as error:
                mi.load_dict({"type": kind, parameter: wrong})
            last = str(error.value).strip().splitlines()[-1]
            assert f"{kind}: {parameter} = {wrong} is out of bounds" in last


# A user's models


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setattr(plugin_files, "_users", {})
    return tmp_path


def test_a_users_folder(folder, llvm_variant):
    mi = llvm_variant
    (folder / "users_felt.py").write_text(FELT)
    (folder / "users_cloth.py").write_text(FELT)
    (folder / "_helper.py").write_text("")
    loaded = bk.load_plugins(folder)
    assert loaded == {"users_cloth": "bsdfs", "users_felt": "bsdfs"}
    assert set(loaded) < set(bk.models())
    assert bk.load_plugins(folder / "users_felt.py") == {"users_felt": "bsdfs"}
    bsdf = mi.load_dict({"type": "users_felt"})
    np.testing.assert_allclose(evaluated(mi, bsdf), 0.3 / np.pi * WO_Z, rtol=1e-5)
    assert bk.check(bk.models()["users_cloth"](), only=["chi squared", "plugin is formula"])


@pytest.mark.quick
def test_an_edited_file_is_read_anew(folder, llvm_variant, monkeypatch):
    """In a notebook a model is written step by step; Mitsuba must not keep the first try."""
    mi = llvm_variant
    monkeypatch.setattr(sys, "dont_write_bytecode", False)  # as for users
    file = folder / "users_wool.py"
    for albedo in (0.3, 0.6):
        file.write_text(FELT.replace("0.3", str(albedo)))
        os.utime(file, ns=(0, int(albedo * 10)))
        bk.load_plugins(file)
        bsdf = mi.load_dict({"type": "users_wool"})
        np.testing.assert_allclose(evaluated(mi, bsdf), albedo / np.pi * WO_Z, rtol=1e-5)


@pytest.mark.quick
@pytest.mark.parametrize("name", ["ward", "measured_table", "diffuse", "roughconductor"])
def test_a_taken_name_is_refused(folder, name):
    (folder / f"{name}.py").write_text(FELT)
    with pytest.raises(bk.BrdfkitError, match=f"plugin '{name}'; rename the file"):
        bk.load_plugins(folder)
    assert not plugin_files._users


@pytest.mark.quick
def test_two_files_of_one_name_are_refused(folder):
    for where in ("one", "two"):
        (folder / where).mkdir()
        (folder / where / "users_silk.py").write_text(FELT)
    bk.load_plugins(folder / "one")
    with pytest.raises(bk.BrdfkitError, match=r"one.users_silk\.py is loaded as 'users_silk'"):
        bk.load_plugins(folder / "two")


@pytest.mark.quick
@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "holds no Model"),
        ("def", "cannot be imported"),
        ("1 / 0", "division by zero"),
        (FELT + FELT.replace("Felt", "Two"), "defines 2 models"),
    ],
)
def test_a_file_that_holds_no_model_is_refused(folder, text, said):
    (folder / "users_wrong.py").write_text(text)
    with pytest.raises(bk.BrdfkitError, match=rf"users_wrong\.py.*{said}"):
        bk.load_plugins(folder)
    assert not plugin_files._users
    with pytest.raises(bk.BrdfkitError, match="no Python file"):
        bk.load_plugins(folder / "nowhere.py")


@pytest.mark.quick
@pytest.mark.parametrize(
    ("declared", "said"),
    [
        ("weight(0.3, 'k', (-1, 1))", "'k': a weight is at least 0 or of any sign"),
        ("weight(0.3, 'k', (0.1, math.inf))", "leave out its bounds"),
        ("weight(-0.3, 'k')", "the default -0.3 is out of bounds: it should be at least 0"),
        ("shape(2.0, (0.0, math.inf), 'n')", "'n': a fit searches between the bounds 0 and inf"),
        ("shape(2.0, (3.0, 1.0), 'n')", "the lower first"),
        ("shape(2.0, (0.0, 1.0), 'n')", "the default 2.0 is out of bounds"),
        ("shape(2.0, (0.0, 3.0), 'n', log=True)", "log=True needs bounds above 0"),
    ],
)
def test_a_wrong_declaration_is_refused(folder, declared, said):
    text = f"import math\nfrom brdfkit.model import shape\n{FELT}\n    other = {declared}\n"
    (folder / "users_wrong.py").write_text(text)
    with pytest.raises(bk.BrdfkitError, match=r"users_wrong\.py.*") as caught:
        bk.load_plugins(folder)
    assert said in str(caught.value)


@pytest.mark.quick
@pytest.mark.parametrize(
    ("given", "said"),
    [
        (
            {"type": "ward", "alpa_u": 0.1},
            "ward: there is no parameter 'alpa_u'; did you mean alpha_u",
        ),
        ({"type": "koenderink", "ordre": 8}, "koenderink: .* 'ordre'; did you mean order"),
        ({"type": "schlick", "g": 0.1}, "schlick: there is no parameter 'g'; there are k."),
        ({"type": "mie_hazy", "k": 0.1}, "mie_hazy: there is no parameter 'k'; there are none."),
        ({"type": "transfer_function", "vales": 1.0}, "'vales'; did you mean values"),
        (
            {"type": "emission_absorption", "light": {"type": "constant"}},
            "no parameter 'light'; the",
        ),
    ],
)
def test_a_parameter_that_is_none_is_said(llvm_variant, given, said):
    with pytest.raises(RuntimeError, match=said):
        llvm_variant.load_dict(given)
