"""The plugin files: a file ``plugins/KIND/NAME.py`` is a plugin of that kind, and NAME its type.

No list names them: they are found by being there, brdfkit's own and those of a user's that were
added. Nothing here looks into a file; who uses a kind knows what its files hold.
"""

import importlib
import importlib.util
import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path

from brdfkit import plugins
from brdfkit.errors import BrdfkitError

# Folder → (the class of Mitsuba's, the function that registers one). One line is one kind.
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
MODELS = "bsdfs"  # the kind that a model is
OWN, USERS = "brdfkit.plugins", "brdfkit.user_plugins"  # packages of the files' modules
PACKAGES_OF_MODELS = f"{OWN}.{MODELS}", USERS

_users: dict[str, tuple[str, Path | type]] = {}
_listeners: list[Callable[[], None]] = []


def sources(kind):
    """Name → file of every plugin of a kind; a class, where a notebook defines one in a cell.

    >>> sources("bsdfs")["ward"].name
    'ward.py'
    """
    return _shipped(kind) | {name: s for name, (k, s) in _users.items() if k == kind}


def kind_of(name):
    """The kind of the plugin of that name, None where there is none."""
    return next((kind for kind in KINDS if name in sources(kind)), None)


def add(kind, added):
    """Add a user's plugins, name → file or class; a later one of the same file takes its place.

    Raises `BrdfkitError`, and adds none, where a name is taken by another plugin.
    """
    for name, source in added.items():
        require_free(name, source)
    if not added:
        return
    _users.update({name: (kind, source) for name, source in added.items()})
    for listener in _listeners:
        listener()


def on_added(listener):
    """Call `listener()` whenever plugins were added."""
    _listeners.append(listener)


def files_in(path):
    """The Python files that `path` means: itself, or those of a folder without an underscore."""
    path = Path(path).absolute()
    files = sorted(path.glob("[!_]*.py")) if path.is_dir() else [path]
    if not path.exists() or not files:
        raise BrdfkitError(f"{path} is no Python file and no folder with any.")
    return files


def module(file):
    """The module of a plugin file; that of a user's anew when the file has changed.

    Raises `BrdfkitError` where it cannot be imported.
    """
    for kind in KINDS:
        if _shipped(kind).get(file.stem) == file:
            return importlib.import_module(f"{OWN}.{kind}.{file.stem}")
    if not file.is_file():
        raise BrdfkitError(f"{file} is not a Python file.")
    return _executed(file, file.stat().st_mtime_ns)


@cache
def _shipped(kind):
    files = [f for folder in plugins.__path__ for f in Path(folder, kind).glob("[!_]*.py")]
    return {file.stem: file for file in sorted(files)}


@cache
def _executed(file, _changed):
    name = f"{USERS}.{file.stem}"
    spec = importlib.util.spec_from_file_location(name, file)
    if spec is None:
        raise BrdfkitError(f"{file} is not a Python file.")
    found = importlib.util.module_from_spec(spec)
    sys.modules[name] = found
    try:
        spec.loader.exec_module(found)
    except Exception as error:
        del sys.modules[name]
        raise BrdfkitError(f"{file} cannot be imported: {str(error).rstrip('.')}.") from error
    return found


def require_free(name, source):
    """An error where a plugin of any kind has the name: Mitsuba would go on with that one."""
    _, known = _users.get(name, (None, source))
    if any(name in _shipped(kind) for kind in KINDS):
        owner = "brdfkit has a plugin"
    elif name in _mitsubas():
        owner = "Mitsuba has a plugin"
    elif isinstance(known, Path) and known != source:
        owner = f"{known} is loaded as"
    else:
        return
    what, remedy = (source, "file") if isinstance(source, Path) else (source.__name__, "class")
    raise BrdfkitError(f"{what}: {owner} {name!r}; rename the {remedy}.")


@cache
def _mitsubas():
    """Names of Mitsuba's own plugins."""
    package = Path(importlib.util.find_spec("mitsuba").origin).parent
    return {file.stem for file in (package / "plugins").iterdir()}
