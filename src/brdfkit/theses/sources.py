"""Finds the measurements for a thesis in a folder of third-party files."""

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from brdfkit.core.errors import BrdfkitError

VARIABLE = "BRDFKIT_DATA"


@dataclass(frozen=True)
class Sources:
    """The folder of measurements, and the folder of `tables` transcribed from theses.

    Both are None where no folder is named; a thesis without NEEDS allows that.
    """

    folder: Path | None
    tables: Path | None

    def path(self, name: str) -> Path:
        """Return the path of a measured file, such as ``curet/abrdf.dat``."""
        assert self.folder is not None, "a thesis that needs files has a folder"
        return self.folder / name

    def find_beside(self, name: str) -> Path | None:
        """Return the path of a file beside the folder, such as ``environments/grace.hdr``.

        None where there is no such file.
        """
        path = self.folder and self.folder.resolve().parent / name
        return path if path and path.is_file() else None

    def table(self, name: str) -> Path | None:
        """Return the path of a transcribed table, None where there is no such table."""
        path = self.tables and self.tables / name
        return path if path and path.is_file() else None


def find_sources(
    data: str | Path | None, tables: str | Path | None, needs: Mapping[str, str]
) -> Sources:
    """Find the sources in the folder `data`, or in the folder that BRDFKIT_DATA names.

    `tables` is a folder, by default ``thesis`` beside `data`; `needs` says where to get each file,
    by the file's name. Raises `BrdfkitError` where files are needed and no folder is named, and for
    a missing file.
    """
    named = data or os.environ.get(VARIABLE)
    if not named and not needs:
        return Sources(None, Path(tables) if tables else None)
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
