"""Converts a document to HTML for notebooks, without scripts and without links to other files.

Its colours derive from the notebook's colour of text, so that they suit light and dark themes.
Where a viewer removes the style sheet, plain tables remain.
"""

import base64
from collections.abc import Callable, Sequence
from html import escape
from itertools import groupby
from typing import Any

import numpy as np

from brdfkit.core.colours import to_srgb
from brdfkit.core.documents.parts import (
    SOFT,
    Cell,
    Document,
    Folded,
    Paragraph,
    Picture,
    Row,
    Table,
)
from brdfkit.core.names import to_printable

STYLE = """
.brdfkit { font: 13px/1.45 system-ui, sans-serif; color: inherit; max-width: 62rem; }
.brdfkit .title { font-weight: 600; margin: 0 0 .35em; }
.brdfkit p { margin: .25em 0; }
.brdfkit .wide { overflow-x: auto; }
.brdfkit table { border-collapse: collapse; margin: .35em 0; border: 0;
  font-variant-numeric: tabular-nums; }
.brdfkit.brdfkit tr, .brdfkit tbody tr:nth-child(n):hover { background: none; }
.brdfkit.brdfkit th, .brdfkit.brdfkit td { padding: .15em .9em .15em 0; text-align: left;
  vertical-align: top; border: 0;
  border-bottom: 1px solid color-mix(in srgb, currentColor 16%, transparent);
  max-width: 40rem; white-space: pre-wrap; color: inherit; }
.brdfkit th { font-weight: 600; }
.brdfkit.brdfkit .number { text-align: right; white-space: nowrap; }
.brdfkit tfoot td, .brdfkit .soft { opacity: .68; }
.brdfkit .strong { font-weight: 600; }
.brdfkit .good::before { content: "✓ "; color: #2e9e4f; }
.brdfkit .bad::before { content: "! "; color: #e5484d; font-weight: 700; }
.brdfkit .pictures { display: flex; flex-wrap: wrap; gap: 14px; align-items: flex-end; }
.brdfkit .pictures img, .brdfkit .pictures svg { display: block; margin: .2em 0; max-width: 100%;
  height: auto; }
.brdfkit .chip { display: inline-block; width: .8em; height: .8em; margin-right: .45em;
  border-radius: 2px; vertical-align: -.06em;
  box-shadow: 0 0 0 1px color-mix(in srgb, currentColor 30%, transparent); }
.brdfkit .bar { display: inline-block; position: relative; width: 56px; height: 4px;
  border-radius: 2px; background: color-mix(in srgb, currentColor 18%, transparent);
  vertical-align: .2em; margin-left: .6em; }
.brdfkit .bar i { position: absolute; top: -3px; width: 3px; height: 10px; margin-left: -1px;
  background: currentColor; }
.brdfkit summary { cursor: pointer; opacity: .68; }
.brdfkit pre { white-space: pre-wrap; font-size: 12px; margin: .3em 0 .3em 1em; color: inherit;
  background: none; }
"""


def to_html(document: Document) -> str:
    """Return a document as HTML for the output of a notebook's cell."""
    parts = []
    for kind, group in groupby(document.parts, type):
        made = [MAKERS[kind](part) for part in group]
        parts += [f'<div class="pictures">{"".join(made)}</div>'] if kind is Picture else made
    title = f'<p class="title">{_escape(document.title)}</p>'
    return f'<div class="brdfkit jp-toc-ignore"><style>{STYLE}</style>{title}{"".join(parts)}</div>'


def _format_table(table: Table) -> str:
    """Return a table as HTML that scrolls sideways where it is wide."""
    sides = [' class="number"' if name.startswith(">") else "" for name in table.columns]
    heads = "".join(
        f"<th{side}>{_escape(name.removeprefix('>'))}</th>"
        for name, side in zip(table.columns, sides, strict=True)
    )
    head = f"<thead><tr>{heads}</tr></thead>" if any(table.columns) else ""
    body = f"<tbody>{_format_rows(table.rows, table.columns)}</tbody>"
    foot = f"<tfoot>{_format_rows(table.foot, table.columns)}</tfoot>" if table.foot else ""
    return f'<div class="wide"><table>{head}{body}{foot}</table></div>'


def _format_rows(rows: Sequence[Row], columns: Sequence[str]) -> str:
    """Return the rows of a table as HTML; columns whose names begin with ">" hold numbers."""
    numeric = [name.startswith(">") for name in columns]
    return "".join(
        f"<tr>{''.join(map(_format_cell, row, numeric or [False] * len(row)))}</tr>" for row in rows
    )


def _format_cell(cell: str | Cell, is_number: bool) -> str:
    """Return a cell as HTML: a square of its colour, its text, and a bar with its place."""
    if not isinstance(cell, Cell):
        cell = Cell(cell)
    kinds = " ".join(filter(None, ["number" if is_number else "", cell.kind]))
    attributes = f' class="{kinds}"' if kinds else ""
    attributes += f' title="{_escape(cell.hint)}"' if cell.hint else ""
    content = _format_colour_square(cell.colour) + _escape(cell.text) + _format_bar(cell.place)
    return f"<td{attributes}>{content}</td>"


def _format_colour_square(colour: Sequence[float]) -> str:
    """Return a small square of a linear sRGB colour as HTML, or "" for an empty colour.

    A colour with a channel above 1 is divided by that channel.
    """
    if len(colour) != 3:
        return ""
    rgb = np.maximum(colour, 0)
    red, green, blue = np.round(255 * to_srgb(rgb / max(rgb.max(), 1))).astype(int)
    return f'<span class="chip" style="background:rgb({red},{green},{blue})"></span>'


def _format_bar(place: float | None) -> str:
    """Return a bar with a mark at `place`, from 0 to 1, as HTML, or "" for None."""
    if place is None:
        return ""
    return f'<span class="bar"><i style="left:{100 * place:.0f}%"></i></span>'


def _format_paragraph(paragraph: Paragraph) -> str:
    """Return a paragraph as HTML."""
    kind = f' class="{paragraph.kind}"' if paragraph.kind else ""
    return f"<p{kind}>{'<br>'.join(map(_escape, paragraph.text.splitlines()))}</p>"


def _format_picture(picture: Picture) -> str:
    """Draw a picture and return its HTML, or a sentence that says why it is not shown."""
    try:
        content = picture.draw()
    except Exception as error:  # a user's model may raise anything; the other parts should be shown
        said = f"Not shown: {picture.says} ({type(error).__name__}: {error})."
        return _format_paragraph(Paragraph(said, SOFT))
    if isinstance(content, str):
        return content
    kind = next(kind for start, kind in KINDS.items() if content.startswith(start))
    data = base64.b64encode(content).decode()
    return (
        f'<img src="data:image/{kind};base64,{data}" alt="{_escape(picture.says)}" '
        f'width="{picture.width}">'
    )


def _format_folded(folded: Folded) -> str:
    """Return a heading with hidden lines as HTML; a click on the heading shows the lines."""
    text = "\n".join(map(_escape, folded.text.splitlines()))
    return f"<details><summary>{_escape(folded.heading)}</summary><pre>{text}</pre></details>"


def _escape(text: object) -> str:
    """Escape a text for HTML, without its control characters."""
    return escape(to_printable(text))


KINDS = {b"\x89PNG": "png", b"RIFF": "webp", b"\xff\xd8": "jpeg"}  # image formats by first bytes
MAKERS: dict[type, Callable[[Any], str]] = {
    Table: _format_table,
    Paragraph: _format_paragraph,
    Picture: _format_picture,
    Folded: _format_folded,
}
