"""The modules of a folder, which are found by being there: a new file needs no list."""

import importlib
import pkgutil


def names_in(path):
    """The names, in alphabetical order, of the modules of a package with this `__path__`, without
    those that begin with an underscore.

    >>> import brdfkit.materials.formats
    >>> "merl" in names_in(brdfkit.materials.formats.__path__)
    True
    """
    return tuple(sorted(m.name for m in pkgutil.iter_modules(path) if not m.name.startswith("_")))


def modules_in(package, path):
    """The modules of these names of a `package`, imported."""
    return tuple(importlib.import_module(f"{package}.{name}") for name in names_in(path))
