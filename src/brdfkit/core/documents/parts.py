"""The parts of a document: paragraphs, tables, pictures and folded lines."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

GOOD, BAD, STRONG, SOFT = "good", "bad", "strong", "soft"  # kinds of cells and paragraphs


@dataclass(frozen=True)
class Cell:
    """A cell of a table with more than a text.

    `kind` is one of the kinds above and says how the cell stands out. HTML alone shows the rest:
    `hint` under the pointer, `colour`, linear R, G, B, as a small square, and `place`, from 0 to 1,
    as a mark on a bar, for a value between its bounds.
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
    """One or more sentences; `kind`, one of the kinds above, says how they stand out."""

    text: str
    kind: str = ""


@dataclass(frozen=True)
class Picture:
    """A picture, which HTML alone shows.

    `draw()` returns the bytes of a PNG, WebP or JPEG, or the text of an SVG; it is called when the
    picture is shown. `says` describes the picture for those who do not see it; `width` is in pixels
    of a screen.
    """

    draw: Callable[[], bytes | str]
    says: str
    width: int


@dataclass(frozen=True)
class Folded:
    """A `text` whose lines HTML alone shows, below a heading that unfolds them."""

    heading: str
    text: str


Part: TypeAlias = Table | Paragraph | Picture | Folded


@dataclass(frozen=True)
class Document:
    """A `title` and `parts` in their order; pictures that follow each other stand side by side."""

    title: str
    parts: tuple[Part, ...] = ()
