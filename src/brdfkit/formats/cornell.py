"""Cornell Program of Computer Graphics: `.brdf` text with spectral samples.

'#' comments, the number of wavelengths, the wavelengths [nm], then a row per sample:
theta_i phi_i theta_s phi_s [rad] and one value [sr⁻¹] per wavelength. The mirror direction is
at Δφ = 180°. https://www.graphics.cornell.edu/online/measurements/reflectance
"""

import numpy as np

from brdfkit.errors import BrdfkitError
from brdfkit.formats._notes import lone_point, stopping_short
from brdfkit.formats._writing import angles as angles_of
from brdfkit.formats._writing import measured, write_rows
from brdfkit.measured.spectra import wavelengths

NAME = "Cornell"
SUFFIXES = (".brdf",)

MOST_WAVELENGTHS = 4096
NANOMETRES = (100, 100_000)  # what a wavelength can be


def sniff(head):
    """Whether a whole number of plausible wavelengths follows the comments of `head`."""
    lines = [line for line in head.split(b"\n") if line.strip() and not line.startswith(b"#")]
    tokens = b" ".join(lines[:3]).split()
    try:
        return int(tokens[0]) > 0 and _plausible(float(tokens[1]))
    except (ValueError, IndexError):
        return False


def read(source):
    """The samples as `Measured`, its channels the wavelengths: ``("400nm", ...)``.

    Raises `BrdfkitError` for a row with too few or too many columns, text among numbers,
    wavelengths that do not add up, or angles that are not in radians.
    """
    wavelengths, rows = _wavelengths(source)
    columns = 4 + len(wavelengths)
    if not rows:
        raise source.error("has no samples behind its wavelengths; fetch the file again")
    data = np.array([source.numbers(n, line.split(), columns) for n, line in rows])
    angles, values = data[:, :4], data[:, 4:]
    lines = [n for n, _ in rows]
    channels = tuple(f"{w:.10g}nm" for w in wavelengths)
    info = {"format": NAME, **_description(source), **_clipped(values)}
    found = source.measured(lines, angles, values, channels=channels, info=info)
    found.info.update({**lone_point(found.samples), **stopping_short(found.samples)})
    return found


def write(obj, stream):
    """Write the valid samples of a spectral `Measured`, to the last digit."""
    obj = measured(obj, NAME)
    try:
        nm = wavelengths(obj)
    except BrdfkitError:
        raise BrdfkitError(
            f"the format {NAME} holds wavelengths, and {obj.name} has the channels "
            f"{' '.join(obj.channels)[:80]}; choose another suffix, such as .astm."
        ) from None
    if not _possible(nm):
        raise BrdfkitError(
            f"the format {NAME} holds up to {MOST_WAVELENGTHS} wavelengths of {NANOMETRES[0]} to "
            f"{NANOMETRES[1]:,} nm, each once, not those of {obj.name}; choose another suffix."
        )
    samples, valid = obj.samples, obj.samples.valid
    header = [
        f"# {' '.join(obj.name.split())}",
        "# num wls",
        f"{len(nm)}",
        "# wls",
        " ".join(f"{w:.10g}" for w in nm),
        "# theta i  phi i  theta s  phi_s  spectral sample values",
    ]
    write_rows(stream, header, [*angles_of(samples.at(valid)), *samples.values[valid].T])


def _wavelengths(source):
    """The wavelengths, and the lines behind them; they may stand on several lines."""
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
        found += source.numbers(n, line.split())
        used += 1
    if len(found) != count:
        raise source.error(
            f"line {first} announces {count} wavelengths, but the next lines list {len(found)}; "
            "mend the number or fetch the file again"
        )
    if not _possible(found):
        raise source.error(
            f"the wavelengths behind line {first} repeat or are not in nm; mend them"
        )
    return found, source.lines[used:]


def _possible(wavelengths):
    """Whether a file may list these."""
    distinct = len({f"{w:.10g}" for w in wavelengths}) == len(wavelengths) <= MOST_WAVELENGTHS
    return distinct and all(map(_plausible, wavelengths))


def _plausible(wavelength):
    return NANOMETRES[0] <= wavelength <= NANOMETRES[1]


def _description(source):
    """What the comments before the first number say of the sample."""
    told = [c for c in source.comments if c and not c.startswith(("num wls", "wls", "theta i"))]
    return {"description": "; ".join(told)} if told else {}


def _clipped(values):
    zeros = (values == 0).mean()
    if not zeros or (values < 0).any():
        return {}
    return {"clipped": f"{zeros:.1%} of the values are 0: negative ones were set to 0"}
