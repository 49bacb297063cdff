"""Cornell Program of Computer Graphics: `.brdf` text with spectral samples.

'#' comments, the number of wavelengths, the wavelengths [nm], then a row per sample:
theta_i phi_i theta_s phi_s [rad] and one value [sr⁻¹] per wavelength. The mirror direction is
at Δφ = 180°. https://www.graphics.cornell.edu/online/measurements/reflectance
"""

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.materials.formats._writing import (
    note_lone_point,
    note_short_rings,
    require_measured,
    sample_angles,
    write_rows,
)
from brdfkit.materials.measured.long_form import NANOMETRES
from brdfkit.materials.measured.spectrum_to_rgb import wavelengths

NAME = "Cornell"
SUFFIXES = (".brdf",)

MOST_WAVELENGTHS = 4096


def sniff(head):
    """Whether a whole number and a plausible wavelength follow the comments of `head`."""
    lines = [line for line in head.split(b"\n") if line.strip() and not line.startswith(b"#")]
    tokens = b" ".join(lines[:3]).split()
    try:
        return int(tokens[0]) > 0 and _is_plausible(float(tokens[1]))
    except (ValueError, IndexError):
        return False


def read(source):
    """The samples as `Measured`, with the wavelengths as channels: ``("400nm", ...)``.

    Raises `BrdfkitError` for a row with too few or too many columns, text among numbers, a wrong
    number of wavelengths, or angles that are not in radians.
    """
    nanometres, rows = _read_wavelengths(source)
    columns = 4 + len(nanometres)
    if not rows:
        raise source.error("has no samples behind its wavelengths; fetch the file again")
    data = np.array([source.parse_numbers(n, line.split(), columns) for n, line in rows])
    angles, values = data[:, :4], data[:, 4:]
    lines = [n for n, _ in rows]
    channels = tuple(f"{w:.10g}nm" for w in nanometres)
    info = {"format": NAME, **_read_description(source), **_note_clipping(values)}
    found = source.build_from_angles(lines, angles, values, channels=channels, info=info)
    found.info.update({**note_lone_point(found.samples), **note_short_rings(found.samples)})
    return found


def write(obj, stream):
    """Write the valid samples of a spectral `Measured`, to the last digit."""
    obj = require_measured(obj, NAME)
    try:
        nanometres = wavelengths(obj)
    except BrdfkitError:
        raise BrdfkitError(
            f"the format {NAME} holds wavelengths, and {obj.name} has the channels "
            f"{' '.join(obj.channels)[:80]}; choose another suffix, such as .astm."
        ) from None
    if not _are_possible(nanometres):
        raise BrdfkitError(
            f"the format {NAME} holds up to {MOST_WAVELENGTHS} wavelengths of {NANOMETRES[0]} to "
            f"{NANOMETRES[1]:,} nm, each once, not those of {obj.name}; choose another suffix."
        )
    samples, valid = obj.samples, obj.samples.valid
    header = [
        f"# {' '.join(obj.name.split())}",
        "# num wls",
        f"{len(nanometres)}",
        "# wls",
        " ".join(f"{w:.10g}" for w in nanometres),
        "# theta i  phi i  theta s  phi_s  spectral sample values",
    ]
    write_rows(stream, header, [*sample_angles(samples.at(valid)), *samples.values[valid].T])


def _read_wavelengths(source):
    """The wavelengths [nm], which may stand on several lines, and the lines behind them."""
    if not source.lines:
        raise source.error("has comments only, no wavelengths; fetch the file again")
    first, text = source.lines[0]
    if not text.isdecimal() or len(text) > 4 or not 1 <= int(text) <= MOST_WAVELENGTHS:
        raise source.error(
            f"line {first} has {text[:40]!r} where the number of wavelengths belongs; "
            "check that it is a Cornell file"
        )
    count, found, used = int(text), [], 1
    for n, line in source.lines[1:]:
        if len(found) >= count:
            break
        found += source.parse_numbers(n, line.split())
        used += 1
    if len(found) != count:
        raise source.error(
            f"line {first} announces {count} wavelengths, but the next lines list {len(found)}; "
            "mend the number or fetch the file again"
        )
    if not _are_possible(found):
        raise source.error(
            f"the wavelengths behind line {first} repeat or are not in nm; mend them"
        )
    return found, source.lines[used:]


def _are_possible(nanometres):
    """Whether a file may list these wavelengths: not too many, each once, all plausible."""
    distinct = len({f"{w:.10g}" for w in nanometres}) == len(nanometres) <= MOST_WAVELENGTHS
    return distinct and all(map(_is_plausible, nanometres))


def _is_plausible(wavelength):
    return NANOMETRES[0] <= wavelength <= NANOMETRES[1]


def _read_description(source):
    """The comments that describe the sample, as a note."""
    told = [c for c in source.comments if c and not c.startswith(("num wls", "wls", "theta i"))]
    return {"description": "; ".join(told)} if told else {}


def _note_clipping(values):
    """A note if values are 0 and none is negative; otherwise none."""
    zeros = (values == 0).mean()
    if not zeros or (values < 0).any():
        return {}
    return {"clipped": f"{zeros:.1%} of the values are 0: negative ones were set to 0"}
