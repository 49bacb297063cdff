"""Finds the plugin files: ``plugins/KIND/NAME.py`` is a plugin of that kind with the type NAME.

There is no list of plugins: brdfkit finds its own files in their folders, and a user adds files.
The code that uses a kind decides what its files contain.
"""

import importlib
import importlib.util
import pkgutil
import sys
from collections.abc import Callable, Iterable, Mapping
from functools import cache
from importlib.machinery import SourceFileLoader
from pathlib import Path
from types import CodeType, ModuleType
from typing import Any

from brdfkit import plugins
from brdfkit.core.errors import BrdfkitError


def find_module_names(path: Iterable[str]) -> tuple[str, ...]:
    """Return the names of the modules in a package, given by its `__path__`, in alphabetical order.

    Names that begin with an underscore are left out.

    >>> import brdfkit.materials.formats
    >>> "merl" in find_module_names(brdfkit.materials.formats.__path__)
    True
    """
    return tuple(sorted(m.name for m in pkgutil.iter_modules(path) if not m.name.startswith("_")))


def import_modules(package: str, path: Iterable[str]) -> tuple[ModuleType, ...]:
    """Import the modules of a package that `find_module_names` finds in its `__path__`."""
    return tuple(importlib.import_module(f"{package}.{name}") for name in find_module_names(path))


# Kind of plugin, which is its folder's name → (base class in Mitsuba, function that registers it)
KINDS = {
    "bsdfs": ("BSDF", "register_bsdf"),
    "emitters": ("Emitter", "register_emitter"),
    "integrators": ("Integrator", "register_integrator"),
    "phase": ("PhaseFunction", "register_phase"),
    "sensors": ("Sensor", "register_sensor"),
    "shapes": ("Shape", "register_shape"),
    "textures": ("Texture", "register_texture"),
    "volumes": ("Volume", "register_texture"),  # Mitsuba 3.9 has no register_volume
}
MODELS = "bsdfs"  # the kind of every BRDF model
OWN, USERS = "brdfkit.plugins", "brdfkit.user_plugins"  # packages of our and users' plugins
PACKAGES_OF_MODELS = f"{OWN}.{MODELS}", USERS

_users: dict[str, tuple[str, Path | type]] = {}
_listeners: list[Callable[[], None]] = []


def find_plugins(kind: str) -> dict[str, Any]:
    """Return the source of every plugin of a kind by name: its file, or a class from a notebook.

    A kind is a folder of plugins, such as "bsdfs" or "emitters".

    >>> find_plugins("bsdfs")["ward"].name
    'ward.py'
    """
    return _find_own_plugins(kind) | {name: s for name, (k, s) in _users.items() if k == kind}


def find_plugin_kind(name: str) -> str | None:
    """Return the kind of the plugin `name`, such as "bsdfs", or None if no plugin has this name."""
    return next((kind for kind in KINDS if name in find_plugins(kind)), None)


def list_users_files() -> tuple[Path, ...]:
    """Return the files of the plugins that the user has added."""
    return tuple(source for _, source in _users.values() if isinstance(source, Path))


def add_plugins(kind: str, added: Mapping[str, Path | type]) -> None:
    """Add a user's plugins of a kind, files or classes by name.

    A file that is added again, or a class of the same name, replaces the earlier one. Raises
    `BrdfkitError`, and adds none, where another plugin has one of the names.
    """
    for name, source in added.items():
        require_free_name(name, source)
    if not added:
        return
    _users.update({name: (kind, source) for name, source in added.items()})
    for listener in _listeners:
        listener()


def call_when_plugins_added(listener: Callable[[], None]) -> None:
    """Register a function that is called each time after plugins have been added."""
    _listeners.append(listener)


def find_python_files(path: str | Path) -> list[Path]:
    """Return the Python file at `path`, or the files of a folder except those with a leading "_".

    Raises `BrdfkitError` where there are none.
    """
    path = Path(path).absolute()
    files = sorted(path.glob("[!_]*.py")) if path.is_dir() else [path]
    if not path.exists() or not files:
        raise BrdfkitError(f"{path} is no Python file and no folder with any.")
    return files


def import_plugin(file: Path) -> ModuleType:
    """Import a plugin file; a user's file is imported again when it has changed.

    Raises `BrdfkitError` where it cannot be imported.
    """
    for kind in KINDS:
        if _find_own_plugins(kind).get(file.stem) == file:
            return importlib.import_module(f"{OWN}.{kind}.{file.stem}")
    if not file.exists():
        raise BrdfkitError(f"{file} does not exist any more; write it again.")
    if not file.is_file():
        raise BrdfkitError(f"{file} is not a Python file.")
    return _import_user_file(file, file.stat().st_mtime_ns)


@cache
def _find_own_plugins(kind: str) -> dict[str, Path]:
    """Return the files of the plugins of a kind that come with brdfkit, by name."""
    files = [f for folder in plugins.__path__ for f in Path(folder, kind).glob("[!_]*.py")]
    return {file.stem: file for file in sorted(files)}


@cache
def _import_user_file(file: Path, _modified: int) -> ModuleType:
    """Import a user's plugin file; a new `_modified`, its time of change, bypasses the cache."""
    name = f"{USERS}.{file.stem}"
    if file.suffix != ".py":
        raise BrdfkitError(f"{file} is not a Python file.")
    loader = _Loader(name, str(file))
    spec = importlib.util.spec_from_file_location(name, file, loader=loader)
    assert spec is not None, "the suffix .py has a specification"
    imported = importlib.util.module_from_spec(spec)
    sys.modules[name] = imported
    try:
        loader.exec_module(imported)
    except BaseException as error:  # a plugin file may raise anything
        del sys.modules[name]
        if isinstance(error, KeyboardInterrupt):
            raise
        reason = str(error).rstrip(".") or type(error).__name__
        if isinstance(error, SystemExit):
            reason = "it ends the program, by sys.exit"
        raise BrdfkitError(f"{file} cannot be imported: {reason}.") from error
    return imported


class _Loader(SourceFileLoader):
    """Compiles a file whenever it is imported, without Python's cache of compiled files.

    That cache overlooks an edit of the same length within a second.
    """

    def get_code(self, fullname: str) -> CodeType | None:
        return self.source_to_code(self.get_data(self.path), self.path)


def require_free_name(name: str, source: Path | type) -> None:
    """Raise `BrdfkitError` if another plugin than `source`, of any kind, has the `name`.

    Mitsuba would go on using the other plugin.
    """
    _, known = _users.get(name, (None, source))
    if any(name in _find_own_plugins(kind) for kind in KINDS):
        owner = "brdfkit has a plugin"
    elif name in _find_mitsuba_plugins():
        owner = "Mitsuba has a plugin"
    elif isinstance(known, Path) and not _is_same_file(known, source):
        owner = f"{known} is loaded as"
    else:
        return
    what, remedy = (source, "file") if isinstance(source, Path) else (source.__name__, "class")
    raise BrdfkitError(f"{what}: {owner} {name!r}; rename the {remedy}.")


def _is_same_file(known: Path, source: Path | type) -> bool:
    """Return whether `source` is the file `known`, perhaps by another path."""
    return known == source or (
        isinstance(source, Path) and known.exists() and source.exists() and known.samefile(source)
    )


@cache
def _find_mitsuba_plugins() -> set[str]:
    """Return the names of Mitsuba's own plugins."""
    spec = importlib.util.find_spec("mitsuba")
    assert spec is not None, "Mitsuba is installed"
    package = Path(str(spec.origin)).parent
    return {file.stem for file in (package / "plugins").iterdir()}
