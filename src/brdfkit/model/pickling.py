"""Pickles a model: its class, its options and its values.

Another process cannot import a class that a user's file defines. So the pickle holds the path and
the checksum of the file, and unpickling loads the file. Pickles refer to `restored` and
`UsersClass` by these names, which must therefore not change.
"""

import sys
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from brdfkit.core.discovery import plugin_files
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import compute_sha256


@dataclass(frozen=True)
class UsersClass:
    """A reference to a class of a user's file: its `name`, and the file's `path` and `checksum`."""

    name: str
    path: str
    checksum: str

    def load(self) -> Any:
        """Return the class, from a loaded file with the same name, or from the file at `path`.

        Warns if the file has changed since it was pickled, and raises `BrdfkitError` if it is
        missing.
        """
        path = Path(self.path)
        file = plugin_files.find_plugins(plugin_files.MODELS).get(path.stem, path)
        if not file.is_file():
            raise BrdfkitError(
                f"{path}: the file of the model {path.stem!r} is missing; load it from where it "
                'is now, with brdfkit.load_plugins("FILE.py").'
            )
        if compute_sha256(file) != self.checksum:
            warnings.warn(
                f"{file} has changed since the model {path.stem!r} was pickled: its parameters may "
                "mean something else now.",
                stacklevel=4,
            )
        plugin_files.add_plugins(plugin_files.MODELS, {path.stem: file})
        return getattr(plugin_files.import_plugin(file), self.name)


def reduce_model(model: Any) -> tuple[Any, ...]:
    """Return the function and arguments from which `pickle` restores a model (`__reduce__`)."""
    classes = tuple(map(_make_portable, model.made_of()))
    return restored, (classes, model.changed_options(), model.arguments)


def restored(classes: tuple[Any, ...], options: dict[str, Any], values: dict[str, Any]) -> Any:
    """Restore a pickled model from its class, its options and its values (`Model.arguments`).

    The class is the first of `classes`. The others are the models that it sums up, which only have
    to be loaded.
    """
    own, *_ = (c.load() if isinstance(c, UsersClass) else c for c in classes)
    return own.configured(**options)(**values)


def _make_portable(cls: type) -> Any:
    """Return a class in the form to pickle it: a `UsersClass` if a user's file defines it."""
    if cls.__module__.rpartition(".")[0] != plugin_files.USERS:
        return cls
    file = Path(str(sys.modules[cls.__module__].__file__))
    return UsersClass(cls.__name__, str(file), compute_sha256(file))
