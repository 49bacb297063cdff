"""Text files in the style of ASTM E1392, `.astm`: a header of keys, then comma-separated rows.

The last key, VARS, names the columns: theta_i, phi_i, theta_s, phi_s [rad] and the channels [sr⁻¹],
which are R, G, B, or wavelengths such as 465nm, or a single channel. Files of two instruments are
known:

- Cornell/Kodak: phi_i is 0; values may be negative and are kept.
- Light Tec Mini-Diff V2: phi_i is 180°; VARS leaves out phi_s, though the rows have it; the
  wavelengths 465, 525, 630 nm stand for B, G, R; beyond theta_s = 75° nothing was measured: the
  values there merely fall along a straight line to 0, and are masked.

In both, the mirror direction is at Δφ = 180°.
"""

import re
from collections.abc import Sequence
from typing import IO

import numpy as np

from brdfkit.core.colours import RGB
from brdfkit.materials.formats._source import Source
from brdfkit.materials.formats._writing import (
    compute_angles,
    make_channel_error,
    note_suspicious_sample,
    require_measured,
    write_rows,
)
from brdfkit.materials.measured import Measured

NAME = "ASTM"
SUFFIXES = (".astm",)

ANGLES = ("theta_i", "phi_i", "theta_s", "phi_s")
KNOWN_CHANNELS = "R,G,B or wavelengths such as 550nm, or a single channel"
MINI_DIFF = "Mini-Diff"
MINI_DIFF_CHANNELS = ("630nm", "525nm", "465nm")  # channels that are read as R, G, B
MINI_DIFF_LIMIT = np.radians(75) + 1e-6
Lines = list[tuple[int, str]]  # pairs of the number of a line and its text


def sniff(head: bytes) -> bool:
    """Return whether a file that begins with `head` is an ASTM file, by its line VARS."""
    return re.search(rb"^VARS\s", head, re.MULTILINE) is not None


def read(source: Source) -> Measured:
    """Read an ASTM file as a `Measured`, with the channels R, G, B, or those that VARS names.

    Raises `BrdfkitError` when VARS is missing, when a row has another number of columns, when
    NUM_POINTS differs from the number of rows, or when text stands among numbers.
    """
    header, vars_line, rows = _read_header(source)
    names, notes = _read_column_names(source, header["VARS"], vars_line, rows)
    data = source.parse_rows(rows, len(names), ",")
    named = tuple(name for name in names if name not in ANGLES)
    known = _find_channels(named)
    if known is None:
        raise source.error(
            f"line {vars_line} names the channels {', '.join(named)[:80]}, but {KNOWN_CHANNELS} "
            "belong; mend the line"
        )
    channels, columns, note = known
    notes.update(note)

    # Sort the columns, which a file may have in any order
    column = dict(zip(names, data.T, strict=True))
    angles = np.stack([column[name] for name in ANGLES], axis=1)
    values = np.stack([column[name] for name in columns], axis=1)
    valid = np.ones(len(rows), bool)
    if MINI_DIFF in header.get("SYSTEM_NAME", ""):
        valid = angles[:, 2] <= MINI_DIFF_LIMIT
        notes["masked"] = f"{(~valid).sum():,} rows beyond theta_s = 75°, not measured"
    info, lines = {"format": NAME, **header, **notes}, [n for n, _ in rows]
    measured = source.make_measured_from_angles(
        lines, angles, values, valid=valid, channels=channels, info=info
    )
    measured.info.update(note_suspicious_sample(measured.samples))
    return measured


def write(obj: object, stream: IO[bytes]) -> None:
    """Write the valid samples of a `Measured` to an ASTM file, in its own channels."""
    data = require_measured(obj, NAME)
    if not _are_writable_channels(data.channels):
        raise make_channel_error(data, NAME, KNOWN_CHANNELS)
    samples = data.samples.at(data.samples.valid)
    header = [
        f"SAMPLE_NAME {' '.join(data.name.split())}",
        f"NUM_POINTS {len(samples.wi)}",
        f"VARS {','.join((*ANGLES, *data.channels))}",
    ]
    write_rows(stream, header, [*compute_angles(samples), *samples.values.T], ",")


def _read_header(source: Source) -> tuple[dict[str, str], int, Lines]:
    """Return the header's values by key, the number of the line VARS, and the lines of the rows."""
    header: dict[str, str] = {}
    for at, (n, line) in enumerate(source.lines):
        key, *value = line.split(maxsplit=1)
        header[key] = "".join(value)
        if key == "VARS":
            rows = source.lines[at + 1 :]
            announced = header.get("NUM_POINTS", str(len(rows)))
            if rows and announced != str(len(rows)):
                raise source.error(
                    f"NUM_POINTS announces {announced[:20]} rows, but {len(rows)} follow; "
                    "fetch the file again or mend the number"
                )
            return header, n, rows
    raise source.error(
        f"has no line VARS that names its columns; add it, as in 'VARS {','.join((*ANGLES, *RGB))}'"
    )


def _read_column_names(
    source: Source, text: str, vars_line: int, rows: Lines
) -> tuple[list[str], dict[str, str]]:
    """Return the names of the columns in `text`, the line VARS, and phi_s if it is left out.

    The second result is a note on this addition. `vars_line` is the number of the line VARS.
    """
    names = [name.strip() for name in text.split(",")]
    notes = {}
    more = len(rows[0][1].split(",")) - len(names) if rows else 0
    if "phi_s" not in names and names[:3] == list(ANGLES[:3]) and more == 1:
        names.insert(3, "phi_s")
        notes["columns"] = "VARS leaves out phi_s, which is the fourth column"
    if len(set(names)) != len(names) or not set(ANGLES) < set(names):
        raise source.error(
            f"line {vars_line} names the columns {repr(text)[:80]}, but {', '.join(ANGLES)} and at "
            "least one channel belong, each once; mend the line"
        )
    return names, notes


def _find_channels(
    columns: Sequence[str],
) -> tuple[Sequence[str], Sequence[str], dict[str, str]] | None:
    """Return the channels, the columns that hold them, and a note if their names differ.

    The result is None where `columns` cannot be the names of channels.
    """
    if set(columns) == set(RGB):
        return RGB, RGB, {}
    if set(columns) == set(MINI_DIFF_CHANNELS):
        note = f"R, G, B are the values at {', '.join(MINI_DIFF_CHANNELS)}"
        return RGB, MINI_DIFF_CHANNELS, {"channels": note}
    if all(re.fullmatch(r"\d+(\.\d+)?nm", name) for name in columns):
        return columns, columns, {}
    if len(columns) == 1:
        return ("Y",), columns, {"channels": f"Y is the column {columns[0]}"}
    return None


def _are_writable_channels(channels: Sequence[str]) -> bool:
    """Return whether a file can hold these `channels`: whether `read` would understand VARS."""
    words = all(re.fullmatch(r"[^\s,]+", name) for name in channels)
    distinct = len({*ANGLES, *channels}) == len(ANGLES) + len(channels)
    return words and distinct and _find_channels(channels) is not None
