"""The parts of a document: paragraphs, tables, pictures and lines that a click unfolds."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

GOOD, BAD, STRONG, SOFT = "good", "bad", "strong", "soft"  # emphasis of cells and paragraphs


@dataclass(frozen=True)
class Cell:
    """A cell of a table with more than a text.

    `kind` is its emphasis: "good", "bad", "strong", "soft" or "". Only HTML shows the other fields:
    `hint` is a text under the pointer; `colour`, in linear sRGB, a small square; `place`, from 0 to
    1, a mark on a bar, for a value between its bounds.
    """

    text: str
    kind: str = ""
    hint: str = ""
    colour: tuple[float, ...] = ()
    place: float | None = None


Row: TypeAlias = tuple[str | Cell, ...]


@dataclass(frozen=True)
class Table:
    """Rows of cells under the names of the columns.

    Columns whose names begin with ">" hold numbers, flush right. `foot` holds rows that are set
    apart at the end. A table without `columns` has no head.
    """

    rows: tuple[Row, ...]
    columns: tuple[str, ...] = ()
    foot: tuple[Row, ...] = ()


@dataclass(frozen=True)
class Paragraph:
    """One or more sentences; their emphasis `kind` is "good", "bad", "strong", "soft" or ""."""

    text: str
    kind: str = ""


@dataclass(frozen=True)
class Picture:
    """A picture that only HTML shows; plain text leaves it out.

    `draw()` returns the bytes of a PNG, WebP or JPEG, or the text of an SVG; it is called when the
    picture is shown. `says` describes the picture for those who do not see it; `width` is in pixels
    of a screen.
    """

    draw: Callable[[], bytes | str]
    says: str
    width: int


@dataclass(frozen=True)
class Folded:
    """A `text` below a `heading` that unfolds it at a click; plain text leaves both out."""

    heading: str
    text: str


Part: TypeAlias = Table | Paragraph | Picture | Folded


@dataclass(frozen=True)
class Document:
    """A summary: a `title` and `parts` below it; successive pictures stand side by side."""

    title: str
    parts: tuple[Part, ...] = ()
