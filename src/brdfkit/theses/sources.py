"""Where a thesis's measurements lie: a folder of third-party files, which brdfkit does not ship."""

import os
from dataclasses import dataclass
from pathlib import Path

from brdfkit.core.errors import BrdfkitError

VARIABLE = "BRDFKIT_DATA"


@dataclass(frozen=True)
class Sources:
    """`folder`: of the measurements; `tables`: of the tables transcribed from theses, if any.

    Both are None where no folder is named, which a thesis without NEEDS allows.
    """

    folder: Path | None
    tables: Path | None

    def path(self, name):
        """The path of a measured file, as of ``curet/abrdf.dat``."""
        return self.folder / name

    def beside(self, name):
        """The path of a file in a folder beside the measurements, as of ``environments/grace.hdr``;
        None where it is not at hand."""
        path = self.folder and self.folder.resolve().parent / name
        return path if path and path.is_file() else None

    def table(self, name):
        """The path of a transcribed table, None where it is not at hand."""
        path = self.tables and self.tables / name
        return path if path and path.is_file() else None


def find_sources(data, tables, needs):
    """The `Sources` in the folder `data`, or in that which BRDFKIT_DATA names.

    `tables`: a folder, by default ``thesis`` beside `data`; `needs`: name of a file → where to get
    it. Raises `BrdfkitError` where no folder is named that should hold any, and for a file that is
    not there.
    """
    named = data or os.environ.get(VARIABLE)
    if not named and not needs:
        return Sources(None, tables and Path(tables))
    if not named:
        raise BrdfkitError(
            f"No folder of measurements is named: set {VARIABLE} to one, or give --data FOLDER; "
            f"it should hold {', '.join(needs)}."
        )
    folder = Path(named)
    for name, origin in needs.items():
        if not (folder / name).is_file():
            raise BrdfkitError(
                f"{folder / name}: is not there; fetch {origin}, and put it there, or name another "
                f"folder by --data or {VARIABLE}."
            )
    return Sources(folder, Path(tables) if tables else folder.resolve().parent / "thesis")
