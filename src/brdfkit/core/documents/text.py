"""A document as text: the title, and below it, indented, its paragraphs and tables."""

from brdfkit.core.documents.html import to_html
from brdfkit.core.documents.parts import BAD, Cell, Document, Paragraph, Table
from brdfkit.core.names import to_printable

INDENT, BETWEEN = "  ", "  "
MARK = "! "  # of what is bad
NAME = 32  # characters of a name beyond which it has a line of its own


def to_text(document):
    """The text of a `Document`; pictures and what is folded are left out."""
    lines = []
    for part in document.parts:
        if isinstance(part, Table):
            lines += _format_table(part)
        elif isinstance(part, Paragraph):
            mark = MARK if part.kind == BAD else ""
            lines += [f"{mark}{line}" for line in part.text.splitlines()]
    return "\n".join([document.title, *(INDENT + line for line in lines)])


def to_plain_text(cell):
    """The text of a cell, behind a mark where it is bad."""
    if not isinstance(cell, Cell):
        return cell
    return f"{MARK}{cell.text}" if cell.kind == BAD else cell.text


def _format_table(table):
    """The lines of a `Table`: columns as wide as their longest text."""
    titles = [name.removeprefix(">") for name in table.columns]
    lines = (*([titles] if any(titles) else []), *table.rows, *table.foot)
    rows = [[to_printable(to_plain_text(cell)) for cell in line] for line in lines]
    if not rows:
        return []
    if len(table.columns) > 2:
        rows = [line for row in rows for line in _split_long_name(row)]
    widths = [max(map(len, texts)) for texts in zip(*rows, strict=True)]
    if len(table.columns) > 2:
        widths[0] = min(widths[0], NAME)
    names = table.columns or [""] * len(widths)
    sides = [">" if name.startswith(">") else "<" for name in names]
    return [
        BETWEEN.join(f"{t:{s}{w}}" for t, s, w in zip(row, sides, widths, strict=True)).rstrip()
        for row in rows
    ]


def _split_long_name(row):
    """A row of texts; two where its name is long: the name, and below it the numbers."""
    name, *others = row
    return [[name, *("" for _ in others)], ["", *others]] if len(name) > NAME else [row]


class Shown:
    """What tells of itself in `document()`; terminals show it as text, notebooks as HTML."""

    def document(self) -> Document:
        """What the object tells of itself."""
        raise NotImplementedError

    def __str__(self) -> str:
        return to_text(self.document())

    def __repr__(self) -> str:
        return str(self)

    def _repr_html_(self) -> str:
        """What notebooks show; without scripts, and without addresses from elsewhere."""
        return to_html(self.document())
