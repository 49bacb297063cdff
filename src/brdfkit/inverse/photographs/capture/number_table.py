"""Reads tables of numbers from text files that people and programs write: directions of lights."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import require_file

SEPARATORS = re.compile(r"[,;\s]+")
COMMENT = re.compile(r"(?:^|\s)(?:#|%|//).*")
LONGEST = 2**22  # bytes of a table; longer files are no tables of lights
TEXT_SUFFIXES = ".txt", ".csv", ".tsv", ".dat", ".lp"


@dataclass(frozen=True, eq=False)
class NumberTable:
    """A table of numbers in a text file.

    `path`: the file; `names`: the first word of each row where it is no number, as the name of a
    photograph, otherwise empty; `numbers` (rows, columns): the numbers behind it.
    """

    path: Path
    names: tuple[str, ...]
    numbers: FloatArray


def read_words(path: Path) -> list[list[str]]:
    """Return the words of each line of a text file, without comments and empty lines.

    Raises the errors of `read_lines`.
    """
    lines = (SEPARATORS.split(line.strip(" \t,;")) for line in read_lines(path))
    return [words for words in lines if words != [""]]


def read_lines(path: Path) -> list[str]:
    """Return the lines of a text file, without comments, empty lines, and blanks around them.

    Raises `BrdfkitError` for a file that is missing, too long, or no text.
    """
    path = require_file(path)
    if path.stat().st_size > LONGEST:
        raise BrdfkitError(f"{path}: it is too long for a table of lights; give another file.")
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (UnicodeDecodeError, OSError) as error:
        raise BrdfkitError(f"{path}: it is no text; save it as plain text in UTF-8.") from error
    lines = (COMMENT.sub("", line).strip() for line in text.splitlines())
    return [line for line in lines if line]


def read_number_table(path: Path) -> NumberTable:
    """Read the table of numbers in a text file.

    Separators are blanks, commas or semicolons. Lines of words before the table are left out, and
    so is a line with the number of its rows. Raises `BrdfkitError` for rows of different lengths,
    and for words or numbers that are not finite inside the table.
    """
    lines = read_words(path)
    while lines and not any(map(_is_number, lines[0])):
        del lines[0]
    if len(lines) > 1 and len(lines[0]) == 1 != len(lines[1]):
        del lines[0]
    if not lines:
        raise BrdfkitError(f"{path}: there are no numbers in it; see whether it is the right file.")
    named = not _is_number(lines[0][0])
    names = tuple(words[0] for words in lines) if named else ()
    rows = []
    for number, words in enumerate(lines, 1):
        row = words[1:] if named else words
        wrong = next((word for word in row if not _is_number(word)), None)
        if wrong is not None or len(words) != len(lines[0]):
            reason = f"{wrong!r} is no number" if wrong else f"it has {len(words)} columns"
            raise BrdfkitError(
                f"{path}: row {number} of its table is odd: {reason}, where the first row has "
                f"{len(lines[0])} columns; mend that row."
            )
        rows.append([float(word) for word in row])
    numbers = np.array(rows)
    finite = np.isfinite(numbers).all(axis=1)
    if not finite.all():
        raise BrdfkitError(
            f"{path}: row {1 + int(np.argmin(finite))} has a number that is not finite; mend it."
        )
    return NumberTable(path, names, numbers)


def read_vectors(path: Path, count: int | None = None) -> NumberTable:
    """Read a table of vectors, one in each row, of three numbers or more.

    A table of three rows and more columns is turned, unless it is known to be of 3 lights by
    their `count`. Raises `BrdfkitError` for a table of another shape.
    """
    table = read_number_table(path)
    rows, columns = table.numbers.shape
    if rows == 3 and columns > 3 and count != 3 and not table.names:
        return NumberTable(path, (), table.numbers.T)
    if columns < 3:
        raise BrdfkitError(
            f"{path}: its table has {rows} rows of {columns} numbers; there should be x, y and z "
            "of each light in a row of its own."
        )
    return table


def _is_number(word: str) -> bool:
    """Return whether a word is a number, which may be nan."""
    try:
        float(word)
    except ValueError:
        return False
    return True
