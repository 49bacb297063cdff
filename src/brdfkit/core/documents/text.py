"""Converts a document to text: the title, and below it, indented, its paragraphs and tables."""

from brdfkit.core.documents.html import to_html
from brdfkit.core.documents.parts import BAD, Cell, Document, Paragraph, Table
from brdfkit.core.names import to_printable

INDENT, GAP = "  ", "  "
BAD_MARK = "! "
LONGEST_NAME = 32  # characters; a row with a longer name takes two lines


def to_text(document: Document) -> str:
    """Convert a document to text for a terminal: its title, then paragraphs and tables, indented.

    Pictures are left out, and so is what an HTML page shows only after a click.
    """
    lines = []
    for part in document.parts:
        if isinstance(part, Table):
            lines += _format_table(part)
        elif isinstance(part, Paragraph):
            mark = BAD_MARK if part.kind == BAD else ""
            lines += [f"{mark}{line}" for line in part.text.splitlines()]
    return "\n".join([document.title, *(INDENT + line for line in lines)])


def to_plain_text(cell: str | Cell) -> str:
    """Return the text of a cell, with a mark in front if the cell is bad."""
    if not isinstance(cell, Cell):
        return cell
    return f"{BAD_MARK}{cell.text}" if cell.kind == BAD else cell.text


def _format_table(table: Table) -> list[str]:
    """Return the lines of a table, with columns as wide as their longest text."""
    titles = [name.removeprefix(">") for name in table.columns]
    lines = (*([titles] if any(titles) else []), *table.rows, *table.foot)
    rows = [[to_printable(to_plain_text(cell)) for cell in line] for line in lines]
    if not rows:
        return []
    if len(table.columns) > 2:
        rows = [line for row in rows for line in _split_long_name(row)]
    widths = [max(map(len, texts)) for texts in zip(*rows, strict=True)]
    if len(table.columns) > 2:
        widths[0] = min(widths[0], LONGEST_NAME)
    names = table.columns or [""] * len(widths)
    sides = [">" if name.startswith(">") else "<" for name in names]
    return [
        GAP.join(f"{t:{s}{w}}" for t, s, w in zip(row, sides, widths, strict=True)).rstrip()
        for row in rows
    ]


def _split_long_name(row: list[str]) -> list[list[str]]:
    """Return a row of a table, or two rows if its name is long: the name, then the numbers."""
    name, *others = row
    return [[name, *("" for _ in others)], ["", *others]] if len(name) > LONGEST_NAME else [row]


class Shown:
    """Base class of results: terminals show their `document()` as text, notebooks as HTML."""

    def document(self) -> Document:
        """Return the summary of the object: a title with paragraphs, tables and pictures."""
        raise NotImplementedError

    def __str__(self) -> str:
        return to_text(self.document())

    def __repr__(self) -> str:
        return str(self)

    def _repr_html_(self) -> str:
        """Return the summary as HTML for notebooks, without scripts and outside addresses."""
        return to_html(self.document())
