"""Which LLVM Dr.Jit gets, whatever the machine has; an LLVM before 17 must never run a kernel.

Dr.Jit looks once per process, so that what happens then is tested in processes of their own.
"""

import ctypes.util
import os
import subprocess
import sys
import textwrap
from pathlib import Path
from types import SimpleNamespace

import pytest

from brdfkit.checks import check
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit import llvm

REPLACED = "which is not an LLVM of version 17 or newer"


@pytest.fixture
def machine(tmp_path, monkeypatch):
    """A machine with no LLVM: `machine.add(path)` puts one there, `machine.bundled` names that of
    karellen-llvm-core."""
    prefix, system = tmp_path / "venv", tmp_path / "usr" / "lib"
    fake = SimpleNamespace(prefix=str(prefix), platform="linux", modules={})
    monkeypatch.setattr(llvm, "sys", fake)
    monkeypatch.setattr(llvm, "site", SimpleNamespace(getuserbase=lambda: str(tmp_path / "user")))
    monkeypatch.setattr(llvm, "SYSTEM_FOLDERS", (str(system),))
    monkeypatch.setenv(llvm.VARIABLE, "")

    def add(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(b"")
        return str(path)

    def add_bundled(version="23.1"):
        """As its wheel lays it out: a link without a version in its name."""
        add(prefix / "lib" / f"libLLVM.so.{version}")
        link = prefix / "lib" / "libLLVM.so"
        link.symlink_to(f"libLLVM.so.{version}")
        return str(link)

    return SimpleNamespace(add=add, add_bundled=add_bundled, system=system, fake=fake)


@pytest.mark.quick
@pytest.mark.parametrize(
    ("name", "version"),
    [
        ("libLLVM-15.so.1", 15),
        ("libLLVM-14.0.6.so.1", 14),
        ("libLLVM.so.22.1", 22),
        ("libLLVM-19.so", 19),
        ("libLLVM.so", 0),  # no library, and no version in its name
        ("libother.so.19", 0),
    ],
)
def test_version_by_name(tmp_path, name, version):
    (tmp_path / name).touch()
    assert llvm.read_llvm_version(tmp_path / name) == version
    assert llvm.read_llvm_version(tmp_path / "elsewhere" / name) == 0


@pytest.mark.quick
def test_version_by_asking(monkeypatch):
    """Where the name does not tell: the library is asked, and one that is no LLVM has none."""
    found = llvm.find_llvm_library()
    if found is None:
        pytest.skip("no LLVM 17 or newer here")
    monkeypatch.setattr(llvm, "re", SimpleNamespace(search=lambda *_: None))
    assert llvm.read_llvm_version(found) >= llvm.OLDEST
    assert llvm.read_llvm_version(ctypes.util.find_library("c")) == 0


@pytest.mark.quick
def test_none(machine):
    assert llvm.find_llvm_library() is None


@pytest.mark.quick
@pytest.mark.parametrize("name", ["libLLVM-14.so.1", "libLLVM-15.so.1", "libLLVM.so.16.0"])
def test_old_ones_do_not_count(machine, name, monkeypatch):
    old = machine.add(machine.system / name)
    machine.add_bundled("15.0")  # some system's /usr/lib/libLLVM.so looks like it
    monkeypatch.setenv(llvm.VARIABLE, old)
    assert llvm.find_llvm_library() is None


@pytest.mark.quick
def test_newest_of_the_system(machine):
    for name in ("libLLVM-15.so.1", "libLLVM-19.so.1", "libLLVM.so.22.1", "libLLVM-18.so.1"):
        machine.add(machine.system / name)
    assert Path(llvm.find_llvm_library()).name == "libLLVM.so.22.1"


@pytest.mark.quick
def test_bundled_before_system_and_named_before_bundled(machine, monkeypatch):
    named = machine.add(machine.system / "libLLVM-19.so.1")
    bundled = machine.add_bundled()
    assert llvm.find_llvm_library() == bundled
    monkeypatch.setenv(llvm.VARIABLE, named)
    assert llvm.find_llvm_library() == named


@pytest.mark.quick
def test_the_advice_is_to_install_or_to_import_in_another_order(machine):
    assert llvm.describe_llvm_remedy().startswith("install karellen-llvm-core")
    machine.add_bundled()
    expected = "start Python anew and import brdfkit before mitsuba and drjit"
    assert llvm.describe_llvm_remedy() == expected


@pytest.mark.quick
@pytest.mark.parametrize(
    ("loaded", "found", "advice"),
    [
        (23, "/usr/lib/libLLVM.so.23", "set llvm_ad_rgb"),
        (15, "/usr/lib/libLLVM.so.23", "start Python anew and import brdfkit before"),
        (-1, None, "install karellen-llvm-core"),
    ],
)
def test_a_check_without_llvm_says_what_to_do(monkeypatch, loaded, found, advice):
    monkeypatch.setattr(llvm, "use_variant", lambda: "scalar_rgb")
    monkeypatch.setattr(llvm, "find_loaded_version", lambda: loaded)
    monkeypatch.setattr(llvm, "find_llvm_library", lambda: found)
    with pytest.raises(BrdfkitError, match=f"needs an LLVM or CUDA variant of Mitsuba; {advice}"):
        check("lambert")


@pytest.mark.quick
def test_prepare(machine, monkeypatch):
    llvm.choose_llvm_library()
    assert os.environ[llvm.VARIABLE] == llvm.NO_LIBRARY
    llvm.choose_llvm_library()  # a child process that inherits it is not told off
    bundled = machine.add_bundled()
    llvm.choose_llvm_library()
    assert os.environ[llvm.VARIABLE] == bundled
    monkeypatch.setenv(llvm.VARIABLE, "/nowhere/libLLVM-15.so")
    with pytest.warns(UserWarning, match=f"/nowhere/libLLVM-15.so, {REPLACED}; {bundled} is used"):
        llvm.choose_llvm_library()
    assert os.environ[llvm.VARIABLE] == bundled


@pytest.mark.quick
def test_prepare_leaves_other_systems_alone(machine):
    machine.fake.platform = "darwin"
    machine.add_bundled()
    llvm.choose_llvm_library()
    assert os.environ[llvm.VARIABLE] == ""


# In a process of its own


def python(code, **environment):
    """The finished process of `code`, without what this process told Dr.Jit."""
    env = {k: v for k, v in os.environ.items() if k != llvm.VARIABLE} | environment
    command = [sys.executable, "-c", textwrap.dedent(code)]
    done = subprocess.run(command, capture_output=True, text=True, env=env, timeout=300)
    assert done.returncode >= 0, f"killed by signal {-done.returncode}: {done.stderr}"
    assert done.returncode == 0, done.stderr
    return done


def bad_library():
    """An LLVM 15 or 16 of this machine, with which Dr.Jit aborts."""
    found = [p for f in llvm.SYSTEM_FOLDERS for p in Path("/").glob(f"{f[1:]}/libLLVM*.so*")]
    bad = [str(p) for p in found if llvm.read_llvm_version(p) in (15, 16)]
    if not bad:
        pytest.skip("no LLVM 15 or 16 here")
    return bad[0]


RENDER = """
picture = bk.render(bk.models()["ward"](), size=8, spp=2)
assert picture.pictures["ward"].mean() > 0.01
"""


def test_a_usable_llvm_is_picked():
    if llvm.find_llvm_library() is None:
        pytest.skip("no LLVM 17 or newer here")
    code = f"""
import brdfkit as bk
import drjit as dr
assert dr.detail.llvm_version()[0] >= 17, dr.detail.llvm_version()
import mitsuba as mi
mi.set_variant("llvm_ad_rgb")
{RENDER}
"""
    assert python(code).stderr == ""


def test_a_bad_choice_of_the_user_is_replaced():
    if llvm.find_llvm_library() is None:
        pytest.skip("no LLVM 17 or newer here")
    code = f"""
import brdfkit as bk
import mitsuba as mi
mi.set_variant("llvm_ad_rgb")
{RENDER}
"""
    assert python(code, DRJIT_LIBLLVM_PATH="/nowhere/libLLVM.so").stderr.count(REPLACED) == 1
    assert python(code, DRJIT_LIBLLVM_PATH=bad_library()).stderr.count(REPLACED) == 1


@pytest.mark.parametrize("when", ["before", "after"])
def test_mitsuba_first_with_a_bad_llvm(when):
    """A sentence at the import, an error instead of the kernel that would abort."""
    variant = 'mi.set_variant("llvm_ad_rgb")'
    code = f"""
import mitsuba as mi
{variant if when == "before" else ""}
import brdfkit as bk
try:
    {variant if when == "after" else ""}
    {RENDER.strip().splitlines()[0]}
except bk.BrdfkitError as error:
    assert str(error).endswith("import brdfkit before mitsuba and drjit."), error
    assert "install" not in str(error)
else:
    raise AssertionError("a kernel ran")
"""
    told = python(code, DRJIT_LIBLLVM_PATH=bad_library()).stderr
    assert told.count("UserWarning: Dr.Jit was imported before brdfkit and took LLVM 1") == 1


def test_mitsuba_refused_leaves_a_variant_that_works():
    code = f"""
import mitsuba as mi
import brdfkit as bk
try:
    mi.set_variant("llvm_ad_rgb")
except bk.BrdfkitError:
    pass
assert mi.variant() == "scalar_rgb", mi.variant()
{RENDER}
"""
    python(code, DRJIT_LIBLLVM_PATH=bad_library())


# A machine without LLVM: only the search is replaced, before the package runs its __init__
WITHOUT_LLVM = """
import importlib.util, sys, types
package = types.ModuleType("brdfkit")
package.__path__ = importlib.util.find_spec("brdfkit").submodule_search_locations
sys.modules["brdfkit"] = package
from brdfkit.core.jit import llvm
llvm.find_llvm_library = lambda: None
del sys.modules["brdfkit"]
import brdfkit as bk
assert bk.llvm is llvm
"""


def test_without_llvm_the_scalar_variant_renders():
    code = f"""
{WITHOUT_LLVM}
{RENDER}
import mitsuba as mi
assert mi.variant() == "scalar_rgb", mi.variant()
"""
    code = f"import warnings; warnings.simplefilter('always')\n{code}"
    told = python(code).stderr
    assert told.count("UserWarning") == 1
    assert told.count("scalar_rgb is used; to mend it, install karellen-llvm-core") == 1
    assert "jit" not in told  # Dr.Jit's own lines


@pytest.mark.parametrize(
    ("words", "sentences"),
    [
        (["render", "ward", "--size", "8", "--spp", "1", "-o", "{folder}/a.png"], 1),
        (["fit", "red_plastic", "-m", "lambert", "-q"], 0),
        (["models", "-q"], 0),
    ],
    ids=lambda words: words[0] if isinstance(words, list) else "",
)
def test_without_llvm_the_command_line_works(tmp_path, words, sentences):
    words = [word.format(folder=tmp_path) for word in words]
    told = python(f"{WITHOUT_LLVM}\nfrom brdfkit.cli import main\nmain({words})").stderr
    assert told.count("\n") == sentences, told
    assert told.startswith("brdfkit: ") or not sentences


def test_mitsuba_first_without_llvm_says_import_brdfkit_first():
    """The environment has an LLVM, but Dr.Jit looked before brdfkit could tell."""
    if llvm.find_llvm_library() is None:
        pytest.skip("no LLVM 17 or newer here")
    code = f"import mitsuba\nimport brdfkit as bk\n{RENDER}"
    told = python(code, DRJIT_LIBLLVM_PATH="/nowhere/libLLVM.so").stderr
    assert "import brdfkit before mitsuba" in told
