"""Makes tables for terminals of any width: columns fold or rows become blocks, no word is cut."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from rich.table import Table

Sections: TypeAlias = Sequence[Sequence[Sequence[str]]]  # sections of rows of texts

NAME_WIDTH = 24  # characters of a name beyond which it may fold, where the table is too wide


def make_table(
    columns: Sequence[str], sections: Sections, width: int, title: str | None = None
) -> Table | None:
    """Make a Rich table of at most `width` characters, or None if that would cut a word.

    A column whose name begins with ">" is right-aligned, for numbers. Such columns and the first
    one, which holds names, do not fold, except names of more than NAME_WIDTH characters.
    """
    from rich.box import SIMPLE_HEAD
    from rich.table import Table
    from rich.text import Text

    # The names of the columns, with units on a second line, and their widths
    headers = [column.removeprefix(">").replace(" [", "\n[") for column in columns]
    rows = [row for section in sections for row in section]
    cells = [[h, *texts] for h, *texts in zip(headers, *rows, strict=True)]
    whole = [k == 0 or column.startswith(">") for k, column in enumerate(columns)]
    # `width` minus the gaps between columns is left for texts
    widths = _compute_column_widths(cells, whole, width - 3 * len(columns) + 1)
    if widths is None:
        return None

    table = Table(
        box=SIMPLE_HEAD, title=Text(title) if title else None, title_justify="left", pad_edge=False
    )
    table.show_header = any(columns)
    for column, header, w in zip(columns, headers, widths, strict=True):
        table.add_column(
            Text(header), justify="right" if column[:1] == ">" else "left", width=w, overflow="fold"
        )
    for section in sections:
        for row in section:
            table.add_row(*map(Text, row))
        table.add_section()
    return table


def format_blocks(columns: Sequence[str], sections: Sections, width: int) -> Iterator[str]:
    """Yield the lines of a narrow table, in which the texts of a row stand below each other."""
    for row in (row for section in sections for row in section):
        for k, (column, text) in enumerate(zip(columns, row, strict=True)):
            name = column.removeprefix(">")
            if not (name or text):
                continue
            yield textwrap.fill(
                f"{name}: {text or '-'}" if name else text,
                width,
                initial_indent="  " if k else "",
                subsequent_indent="    ",
                break_long_words=False,
                break_on_hyphens=False,
            )


def _compute_column_widths(
    cells: Sequence[Sequence[str]], whole: Sequence[bool], total: int
) -> list[int] | None:
    """Compute the widths of columns within `total` characters, or None if words do not fit.

    `cells` are the texts of each column; `whole` says which columns must not fold. A column is at
    least as wide as its longest word. The remaining characters are shared in proportion to what the
    columns lack to be as wide as their longest text.
    """
    from rich.cells import cell_len

    full = [max(cell_len(line) for c in column for line in c.split("\n")) for column in cells]
    words = [max((cell_len(w) for c in column for w in c.split()), default=0) for column in cells]
    minimum = [m if w else word for m, w, word in zip(full, whole, words, strict=True)]
    minimum[0] = max(min(minimum[0], NAME_WIDTH), minimum[0] - max(sum(minimum) - total, 0))
    lacking = [m - n for m, n in zip(full, minimum, strict=True)]
    spare = min(total - sum(minimum), sum(lacking))
    if spare < 0:
        return None
    return [n + spare * w // max(sum(lacking), 1) for n, w in zip(minimum, lacking, strict=True)]
