"""Folders of photographs with a table of the directions or positions of their lights, as text.

Each row has x, y and z of a light, perhaps behind the name of its photograph, and perhaps before
its strength, or its red, green and blue. Without names, the rows belong to the photographs in the
order of the numbers in their names.
"""

from __future__ import annotations

from pathlib import Path

from brdfkit.core.errors import BrdfkitError, no_such_error
from brdfkit.inverse.photographs.capture.listing import Listing
from brdfkit.inverse.photographs.capture.making_lights import (
    check_count,
    find_lengths,
    make_distant_lights,
    to_intensities,
)
from brdfkit.inverse.photographs.capture.number_table import (
    TEXT_SUFFIXES,
    NumberTable,
    read_number_table,
    read_vectors,
)
from brdfkit.inverse.photographs.capture.pictures.masks import find_mask_file
from brdfkit.inverse.photographs.capture.pictures.photograph_file import list_photographs

NAME = "photographs with a table of lights"
FALLBACK = True
# Parts of the names of such tables
OF_LIGHTS = "light", "direction", "position"
OF_INTENSITIES = "intens", "strength"


def find_listing(folder: Path) -> Listing | None:
    """Return the `Listing` of a folder with one table of lights, or None without such a table."""
    photographs = list_photographs(folder)
    path = _find_text(folder, OF_LIGHTS, OF_INTENSITIES) or _find_any_table(folder, photographs)
    if path is None or not photographs:
        return None
    table = read_vectors(path, len(photographs))
    photographs = _match_names(table, photographs)
    check_count(path, len(table.numbers), photographs)
    vectors = table.numbers[:, :3]
    strengths = _find_text(folder, OF_INTENSITIES)
    numbers = None
    if table.numbers.shape[1] > 3:
        strengths, numbers = path, table.numbers[:, 3:]
    elif strengths is not None:
        numbers = read_number_table(strengths).numbers
    intensities = None
    if strengths is not None and numbers is not None:
        intensities = to_intensities(strengths, numbers, len(photographs))
    return Listing(
        name=folder.resolve().name,
        photographs=photographs,
        lights=make_distant_lights(path, vectors, intensities),
        lights_file=path,
        has_intensities=intensities is not None,
        is_ordered_by_number=not table.names,
        lengths=None if intensities is not None else find_lengths(vectors),
        mask=find_mask_file(folder),
    )


def _find_any_table(folder: Path, photographs: tuple[Path, ...]) -> Path | None:
    """Return a text file whose table has a row of three numbers or more for each photograph."""
    for path in sorted(folder.iterdir()):
        if path.suffix.lower() in TEXT_SUFFIXES and path.is_file():
            try:
                table = read_vectors(path, len(photographs))
            except BrdfkitError:  # another text, such as a README
                continue
            if len(table.numbers) == len(photographs):
                return path
    return None


def _find_text(folder: Path, words: tuple[str, ...], without: tuple[str, ...] = ()) -> Path | None:
    """Return the text file in a folder whose name has one of the `words`, and none of `without`."""
    found = []
    for file in sorted(folder.iterdir()):
        name = file.stem.lower()
        is_text = file.suffix.lower() in TEXT_SUFFIXES and file.is_file()
        if is_text and any(w in name for w in words) and not any(w in name for w in without):
            found.append(file)
    if len(found) > 1:
        raise BrdfkitError(
            f"{folder}: {found[0].name} and {found[1].name} could both be the table of lights; "
            "leave one of them."
        )
    return found[0] if found else None


def _match_names(table: NumberTable, photographs: tuple[Path, ...]) -> tuple[Path, ...]:
    """Return the photographs in the order of the names in a table, if it has names."""
    if not table.names:
        return photographs
    known = {path.name: path for path in photographs} | {path.stem: path for path in photographs}
    for name in table.names:
        if Path(name).name not in known:
            raise no_such_error("photograph", name, [p.name for p in photographs], str(table.path))
    return tuple(known[Path(name).name] for name in table.names)
