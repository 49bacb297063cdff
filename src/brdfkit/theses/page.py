"""Writes sections with claims, tables and figures as one Markdown page, with PNGs beside it."""

import io
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from brdfkit.core.files import write_safely
from brdfkit.theses.claims import Claim, describe_counts

HEAD = "claim", "where", "printed", "ours", "verdict"
ARITHMETIC = """Formulas at values that were computed apart, and sums of printed figures. They test
the code and the print, not what the thesis found, and do not count as claims."""
RESOLUTION = 90  # dots per inch of the figures


@dataclass(frozen=True)
class Table:
    """A table of texts on the page.

    columns : the headings.
    rows : the texts of each row, one per heading.
    caption : Markdown below the table.
    """

    columns: Sequence[str]
    rows: Sequence[Sequence[str]]
    caption: str = ""


@dataclass(frozen=True)
class Picture:
    """A figure on the page.

    name : the name of its file without the suffix.
    figure : the figure of matplotlib, or the bytes of its PNG.
    caption : Markdown below the figure.
    """

    name: str
    figure: Any = field(repr=False)
    caption: str = ""


@dataclass(frozen=True)
class Section:
    """A part of a thesis's page: a heading, paragraphs of Markdown, claims, tables and figures."""

    title: str
    text: str = ""
    claims: Sequence[Claim] = ()
    tables: Sequence[Table] = ()
    pictures: Sequence[Picture] = ()


def encode_pictures(section: Section) -> Section:
    """Return a section with PNGs in place of its figures, which can be sent to other processes."""
    pictures = [replace(one, figure=_encode_small_png(one.figure)) for one in section.pictures]
    return replace(section, pictures=pictures)


def write_page(
    file: str | Path,
    title: str,
    introduction: str,
    sections: Sequence[Section],
    missing: Sequence[str] = (),
) -> list[Path]:
    """Write a page as Markdown, and its figures into the same folder; return all paths.

    `missing` holds the titles of parts that were not finished; the page lists them.
    """
    file = Path(file)
    pictures = [picture for section in sections for picture in section.pictures]
    paths = {picture.name: _make_picture_path(file, picture) for picture in pictures}
    for picture in pictures:
        with write_safely(paths[picture.name]) as beside:
            figure = picture.figure
            beside.write_bytes(figure if isinstance(figure, bytes) else _encode_small_png(figure))
    with write_safely(file) as beside:
        beside.write_text(
            _format_page(file, title, introduction, sections, missing), encoding="utf-8"
        )
    return [file, *paths.values()]


def _format_page(
    file: Path, title: str, introduction: str, sections: Sequence[Section], missing: Sequence[str]
) -> str:
    """Return the text of the page in Markdown: a table of all claims, then the sections."""
    claims = [claim for section in sections for claim in section.claims]
    blocks = [f"# {title}", introduction.strip()]
    if missing:
        blocks.append(f"**Not finished**: {', '.join(missing)}.")
    groups = [[c for c in claims if c.arithmetic is arithmetic] for arithmetic in (False, True)]
    blocks += ["## The claims", f"{describe_counts(claims)}."]
    blocks.append(_format_table(HEAD, [_format_claim(claim) for claim in groups[0]]))
    if groups[1]:
        blocks += ["## Checks of arithmetic", ARITHMETIC]
        blocks.append(_format_table(HEAD, [_format_claim(claim) for claim in groups[1]]))
    for section in sections:
        blocks += [f"## {section.title}", section.text.strip()]
        blocks += [_format_reason(claim) for claim in section.claims if claim.why]
        for table in section.tables:
            blocks += [_format_table(table.columns, table.rows), table.caption]
        for picture in section.pictures:
            path = _make_picture_path(file, picture).name
            blocks += [f"![{section.title}]({path})", picture.caption]
    return "\n\n".join(filter(None, blocks)) + "\n"


def _format_claim(claim: Claim) -> tuple[str, ...]:
    """Return the row of a claim in the table of claims."""
    return claim.says, claim.where, claim.printed, claim.ours, f"**{claim.verdict}**"


def _format_reason(claim: Claim) -> str:
    """Return a list item of Markdown that says why the figures of a claim differ."""
    return f"- *{claim.says}* **{claim.verdict}.** {claim.why}"


def _format_table(columns: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return a table as Markdown."""
    lines: list[Sequence[str]] = [columns, ["---"] * len(columns), *rows]
    return "\n".join("| " + " | ".join(_format_cell(c) for c in line) + " |" for line in lines)


def _format_cell(text: object) -> str:
    """Return a text for a cell of a Markdown table: one line without vertical bars."""
    return " ".join(str(text).split()).replace("|", "∣")


def _make_picture_path(file: Path, picture: Picture) -> Path:
    """Return the path of a figure of the page `file`."""
    return file.with_name(f"{file.stem}_{picture.name}.png")


def _encode_small_png(figure: Any) -> bytes:
    """Return a figure as a PNG with a palette, a third as large as one without."""
    from PIL import Image

    full_colour = io.BytesIO()
    figure.savefig(full_colour, format="png", dpi=RESOLUTION)
    image = (
        Image.open(full_colour)
        .convert("RGB")
        .quantize(256, Image.Quantize.MAXCOVERAGE, kmeans=3, dither=Image.Dither.NONE)
    )
    small = io.BytesIO()
    image.save(small, format="png", optimize=True)
    return small.getvalue()
