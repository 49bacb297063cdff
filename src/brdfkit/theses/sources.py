"""Finds the measurements for a thesis in a folder of third-party files."""

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from brdfkit.core.errors import BrdfkitError

VARIABLE = "BRDFKIT_DATA"


@dataclass(frozen=True)
class Sources:
    """The folders with files that a thesis's claims need.

    folder : the folder of measurements, or None where none is named and the thesis needs none.
    tables : the folder of tables transcribed from theses, or None.
    """

    folder: Path | None
    tables: Path | None

    def find_file(self, name: str) -> Path:
        """Return the path of a measured file, such as ``curet/abrdf.dat``."""
        assert self.folder is not None, "a thesis that needs files has a folder"
        return self.folder / name

    def find_beside(self, name: str) -> Path | None:
        """Return the path of a file in the parent folder, such as ``environments/grace.hdr``.

        Returns None where there is no such file.
        """
        path = self.folder and self.folder.resolve().parent / name
        return path if path and path.is_file() else None

    def find_table(self, name: str) -> Path | None:
        """Return the path of a table transcribed from a thesis, or None where it is missing."""
        path = self.tables and self.tables / name
        return path if path and path.is_file() else None


def find_sources(
    data: str | Path | None, tables: str | Path | None, needs: Mapping[str, str]
) -> Sources:
    """Find the files of a thesis in the folder `data`, or in the one that BRDFKIT_DATA names.

    `tables` is a folder, by default ``thesis`` beside `data`; `needs` maps the name of each file to
    the place where to get it. Raises `BrdfkitError` where files are needed and no folder is named,
    and for a missing file.
    """
    named = data or os.environ.get(VARIABLE)
    if not named and not needs:
        return Sources(None, Path(tables).absolute() if tables else None)
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
    beside = Path(tables).absolute() if tables else folder.resolve().parent / "thesis"
    return Sources(folder.absolute(), beside)
