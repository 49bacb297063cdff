"""The kinds of folders with photographs of an object; each module of this folder is one kind.

A new module is found without registration. It defines

- ``NAME``: the kind's name for people;
- ``find_listing(folder)``: returns the `Listing` of a folder of this kind, or None for a folder of
  another kind; raises `BrdfkitError` for one of this kind that is damaged;
- ``FALLBACK = True`` for a kind that is only tried where a folder is of no other kind.
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
    for is_fallback in False, True:
        kinds = [m for m in list_kinds() if getattr(m, "FALLBACK", False) == is_fallback]
        listings = {module.NAME: module.find_listing(folder) for module in kinds}
        found = {name: listing for name, listing in listings.items() if listing is not None}
        if len(found) > 1:
            raise BrdfkitError(
                f"{folder}: it could be {' or '.join(found)}; leave the files of one of them."
            )
        if found:
            return next(iter(found.values()))
    return None
