"""Registers the plugins in Mitsuba when it is imported, whenever and by whatever code.

`import brdfkit` must stay fast, for the `--help` of the command line, and so does not import
Mitsuba. Yet afterwards a scene with `<bsdf type="ward">` should load. So one finder on
`sys.meta_path` waits for the import of Mitsuba, and another one for that of Dr.Jit, which looks for
LLVM.
"""

import functools
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import Any

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.interrupts import delay_signals
from brdfkit.core.jit import llvm


def install_import_hook() -> None:
    """Register the plugins now if Mitsuba is imported already, or else when it gets imported."""
    sys.meta_path.insert(0, _After("drjit", lambda: None))
    if "mitsuba" in sys.modules:
        _register_in_mitsuba()
    else:
        sys.meta_path.insert(0, _After("mitsuba", _register_in_mitsuba))


class _After:
    """A finder that finds a module by the other finders, and calls `then()` after its import."""

    def __init__(self, module: str, then: Callable[[], None]) -> None:
        self.module, self.then = module, then

    def find_spec(
        self, name: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        if name != self.module:
            return None
        spec = self._find_spec_by_others(path, target)
        if spec is not None and spec.loader is not None:
            load = spec.loader.exec_module

            def exec_module(module: ModuleType) -> None:
                with delay_signals():
                    with _silence_missing_llvm():
                        load(module)
                    _forward_to_successor(module)
                    self.then()

            spec.loader.exec_module = exec_module
        return spec

    def _find_spec_by_others(self, path: Sequence[str] | None, target: ModuleType | None) -> Any:
        """Return the import specification of the module, from another finder that has one."""
        # sys.meta_path stays as it is meanwhile, since another thread may be going through it
        others = [f for f in sys.meta_path if hasattr(f, "find_spec") and not isinstance(f, _After)]
        specs = (finder.find_spec(self.module, path, target) for finder in others)
        return next((spec for spec in specs if spec is not None), None)


def _forward_to_successor(module: ModuleType) -> None:
    """Let a `module` return the attributes of its successor in `sys.modules`, if it has one.

    Mitsuba replaces its module while it is imported. A thread that imports Mitsuba at the same time
    gets the replaced one.
    """
    if sys.modules[module.__name__] is not module:
        vars(module)["__getattr__"] = functools.partial(getattr, sys.modules[module.__name__])


def _register_in_mitsuba() -> None:
    """Register the plugins in Mitsuba's current variant, and in each one that is set later."""
    import mitsuba as mi

    from brdfkit.core.discovery import plugin_files
    from brdfkit.mitsuba_bridge.registration.registering import register_new_plugins

    def register_in_variant(before: str | None = None, variant: str | None = None) -> None:
        try:
            llvm.require_safe_variant(variant)
        except BrdfkitError:
            mi.set_variant("scalar_rgb")  # otherwise the refused variant would stay set
            raise
        register_new_plugins()

    mi.detail.add_variant_callback(register_in_variant)
    plugin_files.call_when_plugins_added(register_new_plugins)
    register_new_plugins()


@contextmanager
def _silence_missing_llvm() -> Iterator[None]:
    """Silence Dr.Jit's message about a missing LLVM, which brdfkit reports when it matters."""
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
