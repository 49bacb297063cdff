"""Reads tables of text as spreadsheets write them: a line of column names, then rows of numbers.

Tabs, semicolons, commas or blanks separate the columns. Numbers may have decimal commas where the
separator is no comma, or in quotes.
"""

import csv
import re
from collections.abc import Sequence
from itertools import takewhile
from pathlib import Path

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.materials.formats._source import Source
from brdfkit.materials.measured.angles import DEGREES, RADIANS
from brdfkit.materials.measured.column_names import (
    PER_STERADIAN,
    are_sample_columns,
    match_channel_column,
)
from brdfkit.materials.measured.long_form import parse_colour_name

# Columns are separated by the first of these characters that occurs in the line with the names of
# the columns, or else by blanks
DELIMITERS = "\t;,"
UNITS = {"", *DEGREES, *RADIANS, *PER_STERADIAN, "nm"}
WHOLE = re.compile(r"[-+]?[0-9]*([eE][-+]?[0-9]+)?")
MISSING = {"", "na", "n/a", "#n/a", "-"}  # texts in place of a number that was not measured
NUMERIC = re.compile(r"[-+0-9.,;eE\s]+")
Lines = list[tuple[int, str]]  # pairs of the number of a line and its text


def detect_delimiter(head: bytes) -> str | None:
    """Return the separator of the columns in a text file that begins with the bytes `head`.

    It is one of `DELIMITERS` or " ". The result is None unless a line of `head` has the column
    names of BRDF samples.
    """
    header, _ = _find_header(Source(Path("head"), None, head))
    if header is None or not are_sample_columns(split_fields(header)):
        return None
    return _choose_delimiter(header)


def read_columns(source: Source) -> tuple[list[str], list[int], list[FloatArray]]:
    """Return the names of a table's columns, the line numbers of its rows, and the columns (n,).

    Columns without a name and rows without numbers are left out. An empty field becomes NaN. Raises
    `BrdfkitError` for a row with another number of columns, or with text among numbers.
    """
    header, rows = _find_header(source)
    if header is None:
        line = f"line {rows[0][0]} has numbers" if rows else "it has no line"
        raise source.error(
            f"{line} where the names of the columns belong; add them, as in "
            "'theta_i,phi_i,theta_o,phi_o,BRDF'"
        )
    delimiter = _choose_delimiter(header)
    names, rows = _append_units_to_names(split_fields(header), rows, delimiter)
    # Skip columns without a name, such as the index that pandas writes as the first column
    named = [k for k, name in enumerate(names) if name]
    texts = [k for k in named if match_channel_column(names[k]) == "channel"]
    lines: list[int] = []
    data: list[list[float]] = []
    marks: dict[str, int] = {}
    for n, line in rows:
        fields = split_fields(line, delimiter)
        if not any(fields):  # spreadsheets write rows of delimiters alone at the end
            continue
        _refuse_split_numbers(source, n, fields, names, delimiter)
        source.require_column_count(n, fields, len(names))
        _require_one_decimal_mark(source, n, " ".join(fields), marks)
        for k in texts:
            fields[k] = str(parse_colour_name(fields[k]))
        lines.append(n)
        data.append(source.parse_numbers(n, [_to_python_number(fields[k]) for k in named]))
    if not lines:
        raise source.error("has no rows behind the names of its columns; fetch the file again")
    return [names[k] for k in named], lines, list(np.array(data).T)


def split_fields(line: str, delimiter: str | None = None) -> list[str]:
    """Split a line into its fields, and strip the blanks and quotes around them."""
    delimiter = delimiter or _choose_delimiter(line)
    if delimiter == " ":
        fields = line.split()
    elif '"' in line:
        fields = next(csv.reader([line], delimiter=delimiter, skipinitialspace=True))
    else:
        fields = line.split(delimiter)
    return [field.strip(' \t"') for field in fields]


def _find_header(source: Source) -> tuple[str | None, Lines]:
    """Return the line with the columns' names, or None, and the lines behind it.

    Lines of text may precede it. Where the file begins with numbers, the names may stand in a
    comment, as NumPy's `savetxt` writes them. If no line has names of BRDF samples, the first line
    of text is returned, about which `read_columns` then complains.
    """
    lines = source.whole_lines
    texts = [line for _, line in takewhile(lambda row: not NUMERIC.fullmatch(row[1]), lines)]
    if texts:
        first = next(
            (k for k, text in enumerate(texts) if are_sample_columns(split_fields(text))), 0
        )
        return texts[first], lines[first + 1 :]
    comments = [c for c in source.comments if are_sample_columns(split_fields(c))]
    return (comments[-1] if comments else None), lines


def _choose_delimiter(header: str) -> str:
    """Return the separator of the columns, given the line with their names."""
    return next((mark for mark in DELIMITERS if mark in header), " ")


def _append_units_to_names(
    names: list[str], rows: Lines, delimiter: str
) -> tuple[list[str], Lines]:
    """Append units to the columns' names if the first row states them, and remove that row."""
    units = split_fields(rows[0][1], delimiter) if rows else []
    if len(units) != len(names) or not any(units) or not UNITS.issuperset(map(str.lower, units)):
        return names, rows
    pairs = zip(names, units, strict=True)
    return [f"{n} [{u}]" if u and n[-1:] not in ")]" else n for n, u in pairs], rows[1:]


def _refuse_split_numbers(
    source: Source, line: int, fields: Sequence[str], names: Sequence[str], delimiter: str
) -> None:
    """Raise `BrdfkitError` where decimal commas in a comma-separated file split numbers in two."""
    few = len(names)
    many = max(count for count, field in enumerate(fields, 1) if field)
    if delimiter == "," and few < many <= 2 * few and all(map(WHOLE.fullmatch, fields)):
        raise source.error(
            f"line {line} has {many} columns where {few} belong, probably because decimal commas "
            "split numbers in two; save the file with semicolons between the columns, or with "
            "decimal points"
        )


def _require_one_decimal_mark(source: Source, line: int, text: str, marks: dict[str, int]) -> None:
    """Raise `BrdfkitError` if the numbers of a file contain both points and commas.

    One of the two would then separate thousands. `text` has the fields of line number `line`.
    `marks` has the number of the first line with a point or a comma, and is updated.
    """
    marks |= {mark: line for mark in ",." if mark in text and mark not in marks}
    if len(marks) == 2:
        raise source.error(
            f"line {marks[',']} has a comma and line {marks['.']} a point in a number; "
            "write all numbers with one of them, without separators of thousands"
        )


def _to_python_number(text: str) -> str:
    """Convert the text of a number to Python's notation, with "nan" where nothing was measured."""
    return "nan" if text.lower() in MISSING else text.replace(",", ".")
