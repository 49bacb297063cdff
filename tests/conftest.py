"""Shared by all tests: the variant, the models, and where third-party measurements lie."""

import gc
import itertools
import os
import signal
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import kernel_compilation
import pytest
import syntax_memory
from chromium import start_chromium, stop_chromium

import brdfkit as bk
from brdfkit.core.discovery import plugin_files
from brdfkit.model import labels

# Notebooks' format imports it for a check of addresses that none has: 3 s, for a grammar
sys.modules["rfc3987_syntax"] = None


def pytest_configure(config):
    """Keep the user's cache folder out of it, where commands remember what they wrote.

    Share the cores: the threads of Dr.Jit's in one worker would wait for those in another. And
    hear Ctrl-C, as what the tests start should, where a shell in the background ignores it."""
    import drjit as dr
    import matplotlib as mpl

    os.environ["MPLCONFIGDIR"] = mpl.get_cachedir()  # its list of fonts takes seconds to make
    folder = TemporaryDirectory(prefix="brdfkit-tests-")
    config.add_cleanup(folder.cleanup)
    config.add_cleanup(stop_chromium)
    os.environ["XDG_CACHE_HOME"] = folder.name
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    workers = int(os.environ.get("PYTEST_XDIST_WORKER_COUNT", 1))
    dr.set_thread_count(max(1, (os.cpu_count() or 1) // workers))
    kernel_compilation.shorten()
    syntax_memory.remember()


@pytest.fixture
def llvm_variant():
    """Mitsuba in llvm_ad_rgb."""
    import mitsuba as mi

    mi.set_variant("llvm_ad_rgb")
    return mi


@pytest.fixture(scope="module")
def module_in_llvm():
    """Mitsuba in llvm_ad_rgb for all tests of a file; afterwards the old variant is back."""
    import mitsuba as mi

    before = mi.variant()
    mi.set_variant("llvm_ad_rgb")
    yield mi
    if before:
        mi.set_variant(before)


@pytest.fixture(scope="module")
def mi(module_in_llvm):
    """The same, by Mitsuba's usual name."""
    return module_in_llvm


_before = []  # the variant before the first of several tests that ask for `variant`


@pytest.fixture
def variant():
    """A function that sets a variant, which stays for the next test that asks for this: a change
    takes Mitsuba 0.05 s. Before any other test the old variant is back."""
    import mitsuba as mi

    if not _before:
        _before.append(mi.variant() or "llvm_ad_rgb")
    return mi.set_variant


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config, log):
    """Each worker runs tests in their order, in a half of its own, and helps the other at the end:
    so tests of one file share fixtures, and tests of one model share compiled kernels."""
    from xdist.scheduler import WorkStealingScheduling

    return WorkStealingScheduling(config, log)


def pytest_ignore_collect(collection_path, config):
    """A file that does not contain the word is not imported for `-m quick`."""
    if config.option.markexpr == "quick" and collection_path.suffix == ".py":
        return True if "quick" not in collection_path.read_text("utf-8") else None


@pytest.hookimpl(wrapper=True)
def pytest_collection():
    """Collect no garbage meanwhile, and do not look through the thousands of tests later."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.enable()
        gc.freeze()


def pytest_collection_modifyitems(items):
    """The tests of one function run variant by variant, not model by model."""
    functions = itertools.groupby(items, lambda item: item.nodeid.partition("[")[0])
    items[:] = [item for _, tests in functions for item in sorted(tests, key=_variant_of)]


def _variant_of(item):
    """The variant among a test's parameters, "" for a test that does not ask for `variant`."""
    words = item.callspec.params.values() if hasattr(item, "callspec") else ()
    named = (w for w in words if str(w).startswith(("llvm_", "scalar_")))
    return next(named, "") if "variant" in item.fixturenames else ""


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item):
    if _before and "variant" not in item.fixturenames:
        import mitsuba as mi

        mi.set_variant(_before.pop())


@pytest.fixture
def no_user_plugins(monkeypatch):
    """No plugin of a user's is known, and what a test adds is forgotten."""
    monkeypatch.setattr(plugin_files, "_users", {})


@pytest.fixture
def measured_data():
    """The folder of third-party measurements; tests on them are skipped without it."""
    folder = os.environ.get("BRDFKIT_DATA")
    if not folder:
        pytest.skip("BRDFKIT_DATA names no folder of measurements")
    return Path(folder)


def pytest_generate_tests(metafunc):
    """Every model × every test that asks for `model_name`; with every option × `form`."""
    if "model_name" in metafunc.fixturenames:
        metafunc.parametrize("model_name", bk.models())
    if "form" in metafunc.fixturenames:
        metafunc.parametrize("form", forms())


def forms():
    """Every model, and each of its options once with every word, or the next number, it takes."""
    found = list(bk.models())
    for name, model in bk.models().items():
        for option, declared in model.options.items():
            words = declared.choices if isinstance(declared.default, str) else ()
            found += [f"{name}:{option}={w}" for w in words or () if w != declared.default]
            if isinstance(declared.default, int):
                found.append(f"{name}:{option}={declared.default + 1}")
    return found


@pytest.fixture
def configured(form):
    """A model with its options."""
    return labels.model(form)


@pytest.fixture
def model(model_name):
    return bk.models()[model_name]


@pytest.fixture(scope="session")
def browser():
    """Headless Chromium, of which a worker starts one: it takes a second."""
    return start_chromium()
