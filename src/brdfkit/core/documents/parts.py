"""The parts of a document: paragraphs, tables, pictures, and what is folded away."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

GOOD, BAD, STRONG, SOFT = "good", "bad", "strong", "soft"  # kinds of cells and paragraphs


@dataclass(frozen=True)
class Cell:
    """A cell of a table that has more than a `text`.

    `kind`: how it stands out, one of the kinds above; `hint`: what appears under the pointer;
    `colour`: linear R, G, B, shown as a chip; `place`: where a value lies between its bounds, 0 to
    1, shown as a mark on a bar. HTML alone shows the last three.
    """

    text: str
    kind: str = ""
    hint: str = ""
    colour: tuple[float, ...] = ()
    place: float | None = None


Row: TypeAlias = tuple[str | Cell, ...]


@dataclass(frozen=True)
class Table:
    """Rows of cells under the names of the columns; numbers, flush right, under names with ">".

    `foot`: rows that stand apart at the end. A table without `columns` has no head.
    """

    rows: tuple[Row, ...]
    columns: tuple[str, ...] = ()
    foot: tuple[Row, ...] = ()


@dataclass(frozen=True)
class Paragraph:
    """A sentence or several; `kind`: how it stands out, one of the kinds above."""

    text: str
    kind: str = ""


@dataclass(frozen=True)
class Picture:
    """A picture, which HTML alone shows.

    `draw`: gives, when it is shown, the bytes of a PNG, WebP or JPEG, or the text of an SVG;
    `says`: what it shows, for those who do not see it; `width`: in pixels of a screen.
    """

    draw: Callable[[], bytes | str]
    says: str
    width: int


@dataclass(frozen=True)
class Folded:
    """What HTML alone shows, under a heading that unfolds it; `text` keeps its lines."""

    heading: str
    text: str


Part: TypeAlias = Table | Paragraph | Picture | Folded


@dataclass(frozen=True)
class Document:
    """A `title`, and `parts` in their order; pictures that follow each other stand side by side."""

    title: str
    parts: tuple[Part, ...] = ()
