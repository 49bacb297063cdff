"""Makes the plugins known to Mitsuba, whenever and by whomever it is imported.

`import brdfkit` must stay light (the command line's `--help`), yet after it a scene with
`<bsdf type="ward">` should simply load. So a finder waits for the import of Mitsuba.
"""

import importlib.abc
import importlib.util
import os
import sys
from contextlib import contextmanager

from brdfkit import llvm


def install():
    """Register the plugins now, if Mitsuba is there already, or once it gets imported."""
    if "mitsuba" in sys.modules:
        _connect()
    else:
        sys.meta_path.insert(0, _AfterMitsuba())


class _AfterMitsuba(importlib.abc.MetaPathFinder):
    """Finds `mitsuba` as everybody would, and connects to it when it is loaded."""

    def find_spec(self, name, path=None, target=None):
        if name != "mitsuba":
            return None
        sys.meta_path.remove(self)
        spec = importlib.util.find_spec(name)
        if spec is not None and spec.loader is not None:
            load = spec.loader.exec_module

            def exec_module(module):
                with _without_llvm_noise():
                    load(module)
                _connect()

            spec.loader.exec_module = exec_module
        return spec


def _connect():
    import mitsuba as mi

    from brdfkit import registry

    def on_variant(_old=None, variant=None):
        llvm.refuse_bad_choice(variant)
        registry.register_in_mitsuba()

    mi.detail.add_variant_callback(on_variant)
    if mi.variant() is not None:
        registry.register_in_mitsuba()


@contextmanager
def _without_llvm_noise():
    """Dr.Jit prints to stderr that it found no LLVM; brdfkit says so itself, when it matters."""
    if os.environ.get(llvm.VARIABLE) != llvm.NO_LIBRARY:
        yield
        return
    stderr = os.dup(2)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 2)
    try:
        yield
    finally:
        os.dup2(stderr, 2)
        os.close(stderr)
        os.close(nowhere)
