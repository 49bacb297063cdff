"""Shows a `Plan` as a document, and writes it as a table to fill in or as a picture."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from brdfkit.core.documents import Document, Paragraph, Picture, Table
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.figures import to_png
from brdfkit.core.files import write_safely
from brdfkit.materials.measured.column_names import TASK, parse_layout
from brdfkit.materials.measured.coordinates import ANGLES
from brdfkit.materials.measured.evidence import format_logarithm
from brdfkit.materials.measured.validation import Origin

if TYPE_CHECKING:
    from collections.abc import Sequence

PICTURES = ".png", ".pdf", ".svg"
DPI, WIDTH = 100, 760  # resolution [pixels per inch] and width [pixels] of a notebook's picture
CONVENTION = (
    "BRDF in 1/sr, without a cosine; theta from the normal; i to the light, o to the detector; the "
    "mirror direction is at phi_o = phi_i + 180 deg"
)


def make_document(plan: Any) -> Document:
    """Return the document of a `Plan`."""
    rows = tuple(
        (str(k), *(f"{angle:g}°" for angle in angles), format_logarithm(error))
        for k, (angles, error) in enumerate(zip(plan.angles, plan.errors[1:], strict=True), 1)
    )
    columns = (">", ">theta_i", ">theta_o", ">phi", "expected error after it")
    notes = {"halves": describe_halves(plan), **plan.info}
    before = f"Before the first, the expected error is {format_logarithm(plan.errors[0])}."
    says = "places of light and detector, numbered, and the expected error after each"
    return Document(
        f"{len(plan)} directions worth measuring, in the order of their gain",
        (
            Table(rows, columns),
            Paragraph(before),
            Picture(lambda: to_png(plan.picture(), DPI), says, WIDTH),
            Table(tuple(notes.items())),
        ),
    )


def describe_halves(plan: Any) -> str:
    """Return in words how many directions have half the error of fewer.

    It ends with the first number whose half the plan does not reach.
    """
    texts = []
    for fewer, more in plan.halves:
        texts.append(f"of {fewer}: {more}" if more else f"of {fewer}: more than {len(plan)}")
        if more is None:
            break
    return f"directions that have half the error {', '.join(texts)}"


def write_plan(plan: Any, path: Path, channels: Sequence[str]) -> None:
    """Write a `Plan` to a file, completely or not at all."""
    suffix = path.suffix.lower()
    if suffix != ".csv" and suffix not in PICTURES:
        raise BrdfkitError(
            f"{path}: a plan is written as .csv, or as a picture, {', '.join(PICTURES)}; choose "
            "one."
        )
    if suffix == ".csv":
        text = make_table(plan, check_channels(channels))
        with write_safely(path) as part:
            part.write_text(text, encoding="utf-8")
        return
    figure = plan.picture()
    with write_safely(path) as part:
        figure.savefig(part, dpi=130)


def check_channels(channels: Sequence[str]) -> tuple[str, ...]:
    """Return names of columns of values; raise `BrdfkitError` for names that are not read."""
    names = (channels,) if isinstance(channels, str) else tuple(map(str, channels))
    try:
        if names and len(parse_layout([*ANGLES, *names], Origin("channels")).values) == len(names):
            return names
    except BrdfkitError:
        pass  # it is about columns; the sentence below is about channels
    raise BrdfkitError(
        f"channels = {', '.join(names)[:80]} should be R, G, B; or BRDF; or wavelengths such as "
        "450nm, 550nm."
    )


def make_table(plan: Any, channels: Sequence[str]) -> str:
    """Return the text of a table with a row for each direction, and empty fields for the values."""
    notes = {"convention": CONVENTION, **{f"plan {key}": text for key, text in plan.info.items()}}
    lines = [f"# {TASK}"]
    lines += [f"# {key}: {text.replace('°', ' deg')}" for key, text in notes.items()]
    lines += ["# anisotropic: no", ",".join([*(f"{a} [deg]" for a in ANGLES), *channels])]
    for theta_i, theta_o, phi in plan.angles.tolist():
        lines.append(",".join([f"{theta_i:g},0,{theta_o:g},{phi:g}", *("" for _ in channels)]))
    return "\n".join(lines) + "\n"
