"""Folders in which a text file lists the photographs and the mask, and a chrome ball lies beside.

In ``cat/cat.txt`` the first line is the number of photographs; their names follow, and that of the
mask at last. The folder ``chrome`` beside ``cat`` shows a chrome ball under the same lights, and
``lights.txt``, if there is one, has their directions: x to the right, y up, z towards the camera.
"""

from __future__ import annotations

from pathlib import Path

from brdfkit.core.array_types import FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import require_file
from brdfkit.inverse.photographs.capture.chrome_ball import find_light_directions
from brdfkit.inverse.photographs.capture.listing import Listing
from brdfkit.inverse.photographs.capture.making_lights import check_count, make_distant_lights
from brdfkit.inverse.photographs.capture.number_table import read_vectors, read_words
from brdfkit.inverse.photographs.capture.pictures.masks import read_mask
from brdfkit.inverse.photographs.capture.pictures.photograph_file import has_photograph_suffix

NAME = "a series with a chrome ball"
LIGHTS, CHROME = "lights.txt", "chrome"


def find_listing(folder: Path) -> Listing | None:
    """Return the `Listing` of such a folder, or None for another folder."""
    series = _read_series(folder)
    if series is None:
        return None
    photographs, mask = series
    path, directions, notes = _find_directions(folder, len(photographs))
    check_count(path, len(directions), photographs)
    return Listing(
        name=folder.name,
        photographs=photographs,
        lights=make_distant_lights(path, directions),
        lights_file=path,
        mask=mask,
        notes=notes,
    )


def _read_series(folder: Path) -> tuple[tuple[Path, ...], Path] | None:
    """Return the photographs and the mask that a text file of a folder lists, None without one."""
    own = folder / f"{folder.name}.txt"
    files = [own] if own.is_file() else sorted(folder.glob("*.txt"))
    for path in files:
        lines = [" ".join(words) for words in read_words(path)]
        names = lines[1:]
        if lines and lines[0].isdigit() and names and all(map(has_photograph_suffix, names)):
            return _find_files(folder, path, int(lines[0]), names)
    return None


def _find_files(
    folder: Path, path: Path, count: int, names: list[str]
) -> tuple[tuple[Path, ...], Path]:
    """Return `count` photographs and the mask with the `names` that the file at `path` lists."""
    if len(names) != count + 1:
        raise BrdfkitError(
            f"{path}: its first line promises {count} photographs, and {len(names) - 1} names "
            "follow before that of the mask; mend the number or the names."
        )
    return tuple(require_file(folder / name) for name in names[:-1]), require_file(
        folder / names[-1]
    )


def _find_directions(folder: Path, count: int) -> tuple[Path, FloatArray, tuple[str, ...]]:
    """Return the file of the directions of `count` lights, the directions, and notes on them."""
    for path in (folder / LIGHTS, folder.parent / LIGHTS):
        if path.is_file():
            return path, read_vectors(path, count).numbers[:, :3], ()
    chrome = folder.parent / CHROME
    series = _read_series(chrome)
    if series is None:
        raise BrdfkitError(
            f"{folder}: there are neither {LIGHTS} nor a folder {CHROME} with photographs of a "
            "chrome ball, which tell where the lights are; add one of them."
        )
    balls, mask = series
    note = f"the lights were found from {len(balls)} photographs of the chrome ball in {chrome}."
    return chrome, find_light_directions(balls, read_mask(mask)), (note,)
