"""The text format of spectral samples of the Cornell Program of Computer Graphics, `.brdf`.

A file has '#' comments, the number of wavelengths, the wavelengths [nm], then a row per sample:
theta_i phi_i theta_s phi_s [rad] and one value [sr⁻¹] per wavelength. The mirror direction is
at Δφ = 180°. https://www.graphics.cornell.edu/online/measurements/reflectance
"""

from collections.abc import Sequence
from typing import IO

from brdfkit.core.array_types import FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.materials.formats._source import Source
from brdfkit.materials.formats._writing import (
    compute_angles,
    make_channel_error,
    note_missing_views,
    note_suspicious_sample,
    require_measured,
    write_rows,
)
from brdfkit.materials.measured import Measured
from brdfkit.materials.measured.long_form import NANOMETRES
from brdfkit.materials.measured.spectrum_to_rgb import wavelengths

NAME = "Cornell"
SUFFIXES = (".brdf",)

MOST_WAVELENGTHS = 4096


def sniff(head: bytes) -> bool:
    """Return whether `head` begins as a Cornell file does: with a number, then a wavelength."""
    lines = [line for line in head.split(b"\n") if line.strip() and not line.startswith(b"#")]
    tokens = b" ".join(lines[:3]).split()
    try:
        return int(tokens[0]) > 0 and _is_wavelength(float(tokens[1]))
    except (ValueError, IndexError):
        return False


def read(source: Source) -> Measured:
    """Read a Cornell file as a `Measured`, with the wavelengths as channels: ``("400nm", ...)``.

    Raises `BrdfkitError` for a row with too few or too many columns, text among numbers, a wrong
    number of wavelengths, or angles that are not in radians.
    """
    nanometres, rows = _read_wavelengths(source)
    data = source.parse_rows(rows, 4 + len(nanometres))
    angles, values = data[:, :4], data[:, 4:]
    lines = [n for n, _ in rows]
    channels = tuple(f"{w:.10g}nm" for w in nanometres)
    info = {"format": NAME, **_read_description(source), **_note_clipping(values)}
    measured = source.make_measured_from_angles(lines, angles, values, channels=channels, info=info)
    measured.info.update(
        note_suspicious_sample(measured.samples) | note_missing_views(measured.samples)
    )
    return measured


def write(obj: object, stream: IO[bytes]) -> None:
    """Write the valid samples of a spectral `Measured` to a Cornell file."""
    data = require_measured(obj, NAME)
    try:
        nanometres = wavelengths(data)
    except BrdfkitError:
        raise make_channel_error(data, NAME, "wavelengths", ".astm") from None
    if not _are_possible_wavelengths(nanometres):
        raise BrdfkitError(
            f"the format {NAME} holds up to {MOST_WAVELENGTHS} wavelengths of {NANOMETRES[0]} to "
            f"{NANOMETRES[1]:,} nm, each once, not those of {data.name}; choose another suffix."
        )
    samples = data.samples.at(data.samples.valid)
    header = [
        f"# {' '.join(data.name.split())}",
        "# num wls",
        f"{len(nanometres)}",
        "# wls",
        " ".join(f"{w:.10g}" for w in nanometres),
        "# theta i  phi i  theta s  phi_s  spectral sample values",
    ]
    write_rows(stream, header, [*compute_angles(samples), *samples.values.T])


def _read_wavelengths(source: Source) -> tuple[list[float], list[tuple[int, str]]]:
    """Return the wavelengths [nm], from one or more lines, and the lines of samples behind them."""
    if not source.lines:
        raise source.error("has comments only, no wavelengths; fetch the file again")
    first, text = source.lines[0]
    if not text.isdecimal() or len(text) > 4 or not 1 <= int(text) <= MOST_WAVELENGTHS:
        raise source.error(
            f"line {first} has {text[:40]!r} where the number of wavelengths belongs; "
            "check that it is a Cornell file"
        )
    count, used = int(text), 1
    nanometres: list[float] = []
    for n, line in source.lines[1:]:
        if len(nanometres) >= count:
            break
        nanometres += source.parse_numbers(n, line.split())
        used += 1
    if len(nanometres) != count:
        raise source.error(
            f"line {first} announces {count} wavelengths, but the next lines list "
            f"{len(nanometres)}; mend the number or fetch the file again"
        )
    if not _are_possible_wavelengths(nanometres):
        raise source.error(
            f"the wavelengths behind line {first} repeat or are not in nm; mend them"
        )
    return nanometres, source.lines[used:]


def _are_possible_wavelengths(nanometres: Sequence[float] | FloatArray) -> bool:
    """Return whether a file may have these wavelengths: all distinct, plausible, not too many."""
    distinct = len({f"{w:.10g}" for w in nanometres}) == len(nanometres) <= MOST_WAVELENGTHS
    return distinct and all(map(_is_wavelength, nanometres))


def _is_wavelength(wavelength: float) -> bool:
    return NANOMETRES[0] <= wavelength <= NANOMETRES[1]


def _read_description(source: Source) -> dict[str, str]:
    """Return a note with the comments that describe the material, or an empty dictionary."""
    titles = ("num wls", "wls", "theta i")
    comments = [c for c in source.comments if c and not c.startswith(titles)]
    return {"description": "; ".join(comments)} if comments else {}


def _note_clipping(values: FloatArray) -> dict[str, str]:
    """Return a note that negative values were set to 0, or an empty dictionary.

    They surely were if some values are 0 and none is negative, because noise makes values near 0
    negative.
    """
    zeros = (values == 0).mean()
    if not zeros or (values < 0).any():
        return {}
    return {"clipped": f"{zeros:.1%} of the values are 0: negative ones were set to 0"}
