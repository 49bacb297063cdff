"""How a model with values is pickled: its class, its options and its values.

The class of a user's file can be imported in no other process. So the file's path and checksum go
along, and the file is loaded where the pickle is.
"""

import sys
import warnings
from dataclasses import dataclass
from pathlib import Path

from brdfkit.errors import BrdfkitError
from brdfkit.files import sha256
from brdfkit.plugins import discovery


@dataclass(frozen=True)
class UsersClass:
    """A class in a file of a user's: its `name` in the module, the file's `path` and `checksum`."""

    name: str
    path: str
    checksum: str

    def found(self):
        """The class, of the file of that name that was loaded, or else of the one at `path`."""
        path = Path(self.path)
        file = discovery.sources(discovery.MODELS).get(path.stem, path)
        if not file.is_file():
            raise BrdfkitError(
                f"{path}: the file of the model {path.stem!r} is missing; load it from where it "
                'is now, as by brdfkit.load_models("FILE.py").'
            )
        if sha256(file) != self.checksum:
            warnings.warn(
                f"{file} has changed since the model {path.stem!r} was pickled: its parameters may "
                "mean something else now.",
                stacklevel=4,
            )
        discovery.add(discovery.MODELS, {path.stem: file})
        return getattr(discovery.module(file), self.name)


def reduced(model):
    """What `pickle` keeps of a model: see `object.__reduce__`."""
    kept = tuple(map(_kept, model.made_of()))
    return restored, (kept, model.chosen(), model.values)


def restored(kept, options, values):
    """The model of `reduced`; of the classes that it needs, its own is the first."""
    written, *_ = (c.found() if isinstance(c, UsersClass) else c for c in kept)
    return written.configured(**options)(**values)


def _kept(cls):
    """A class as it is pickled: by its name in a module, but for one of a user's file."""
    if cls.__module__.rpartition(".")[0] != discovery.USERS:
        return cls
    file = Path(sys.modules[cls.__module__].__file__)
    return UsersClass(cls.__name__, str(file), sha256(file))
