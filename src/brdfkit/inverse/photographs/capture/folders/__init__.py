"""The kinds of folders with photographs of an object; each module of this folder is one kind.

A new module is found without registration. It defines

- ``NAME``: the kind's name for people;
- ``find_listing(folder)``: returns the `Listing` of a folder of this kind, or None for a folder of
  another kind; raises `BrdfkitError` for one of this kind that is damaged.
"""

from functools import cache
from pathlib import Path
from types import ModuleType

from brdfkit.core.discovery.plugin_files import import_modules
from brdfkit.core.errors import BrdfkitError
from brdfkit.inverse.photographs.capture.listing import Listing


@cache
def list_kinds() -> tuple[ModuleType, ...]:
    """Import the modules of all kinds of folders, and return them in alphabetical order."""
    return import_modules(__name__, __path__)


def find_listing(folder: Path) -> Listing | None:
    """Return the `Listing` of a folder of photographs by its kind, or None if it has none.

    Raises `BrdfkitError` for a folder that could be of several kinds.
    """
    found = {
        module.NAME: listing for module in list_kinds() if (listing := module.find_listing(folder))
    }
    if len(found) > 1:
        raise BrdfkitError(
            f"{folder}: it could be {' or '.join(found)}; leave the files of one of them."
        )
    return next(iter(found.values()), None)
