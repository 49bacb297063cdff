"""Pickles a model with values: its class, its options and its values.

Another process cannot import a class that a user's file defines. So the pickle holds the path and
the checksum of the file, which is loaded with the pickle. Pickles refer to `restored` and
`UsersClass` by these names, which therefore stay.
"""

import sys
import warnings
from dataclasses import dataclass
from pathlib import Path

from brdfkit.core.discovery import plugin_files
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import sha256


@dataclass(frozen=True)
class UsersClass:
    """A class in a user's file: its `name` in the module, the file's `path` and `checksum`."""

    name: str
    path: str
    checksum: str

    def load(self):
        """The class from the loaded file with the name of `path`, else from the file at `path`.

        Warns where the file has changed since, raises `BrdfkitError` where it is missing.
        """
        path = Path(self.path)
        file = plugin_files.find_plugins(plugin_files.MODELS).get(path.stem, path)
        if not file.is_file():
            raise BrdfkitError(
                f"{path}: the file of the model {path.stem!r} is missing; load it from where it "
                'is now, as by brdfkit.load_plugins("FILE.py").'
            )
        if sha256(file) != self.checksum:
            warnings.warn(
                f"{file} has changed since the model {path.stem!r} was pickled: its parameters may "
                "mean something else now.",
                stacklevel=4,
            )
        plugin_files.add_plugins(plugin_files.MODELS, {path.stem: file})
        return getattr(plugin_files.import_plugin(file), self.name)


def reduce_model(model):
    """What `pickle` stores of a model, as `object.__reduce__` returns it."""
    classes = tuple(map(_make_portable, model.made_of()))
    return restored, (classes, model.changed_options(), model.arguments)


def restored(classes, options, values):
    """The model that was pickled; `classes`: its own, then those of its terms; `values`: its
    `Model.arguments`."""
    own, *_ = (c.load() if isinstance(c, UsersClass) else c for c in classes)
    return own.configured(**options)(**values)


def _make_portable(cls):
    """What stands for a class in a pickle: `UsersClass` for one of a user's file, else itself."""
    if cls.__module__.rpartition(".")[0] != plugin_files.USERS:
        return cls
    file = Path(sys.modules[cls.__module__].__file__)
    return UsersClass(cls.__name__, str(file), sha256(file))
