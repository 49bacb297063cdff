"""Makes the plugins known to Mitsuba, whenever and by whomever it is imported.

`import brdfkit` must stay fast, for the command line's `--help`, and so does not import Mitsuba.
Yet after it a scene with `<bsdf type="ward">` should load. So one finder on `sys.meta_path` waits
for the import of Mitsuba, another for that of Dr.Jit, which looks for LLVM.
"""

import functools
import os
import sys
from contextlib import contextmanager

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.interrupts import hold_signals
from brdfkit.core.jit import llvm


def install():
    """Register the plugins now, if Mitsuba is imported already, or when it gets imported."""
    sys.meta_path.insert(0, _After("drjit", lambda: None))
    if "mitsuba" in sys.modules:
        _connect()
    else:
        sys.meta_path.insert(0, _After("mitsuba", _connect))


class _After:
    """A finder that finds `module` by the other finders, and calls `then()` when it is loaded."""

    def __init__(self, module, then):
        self.module, self.then = module, then

    def find_spec(self, name, path=None, target=None):
        if name != self.module:
            return None
        spec = self._find_by_others(path, target)
        if spec is not None and spec.loader is not None:
            load = spec.loader.exec_module

            def exec_module(module):
                with hold_signals():
                    with _without_llvm_noise():
                        load(module)
                    _forward_to_successor(module)
                    self.then()

            spec.loader.exec_module = exec_module
        return spec

    def _find_by_others(self, path, target):
        # sys.meta_path stays as it is: another thread may be looking through it
        others = [f for f in sys.meta_path if hasattr(f, "find_spec") and not isinstance(f, _After)]
        specs = (finder.find_spec(self.module, path, target) for finder in others)
        return next((spec for spec in specs if spec is not None), None)


def _forward_to_successor(module):
    """Give a module the attributes of the module that its import put into its place, if it did.

    Mitsuba's import does: a thread that imports Mitsuba at the same time gets the first module.
    """
    if sys.modules[module.__name__] is not module:
        module.__getattr__ = functools.partial(getattr, sys.modules[module.__name__])


def _connect():
    """Register the plugins in Mitsuba's current variant, and in each one that is set later."""
    import mitsuba as mi

    from brdfkit.core.discovery import plugin_files
    from brdfkit.mitsuba_bridge.registration.registering import register_all

    def on_variant(before=None, variant=None):
        try:
            llvm.require_safe_variant(variant)
        except BrdfkitError:
            mi.set_variant("scalar_rgb")  # or the refused variant would stay set
            raise
        register_all()

    mi.detail.add_variant_callback(on_variant)
    plugin_files.call_when_added(register_all)
    register_all()


@contextmanager
def _without_llvm_noise():
    """Silence Dr.Jit's message that it found no LLVM: brdfkit says so itself, when it matters."""
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
