"""Tables of named columns, `.csv`: what spreadsheets, pandas and goniometers write.

A line names the columns, in any order; every line behind it is a sample. Lines of text before it
are left out, and the units may stand in a line of their own below it. Directions:

- ``theta_i, phi_i, theta_o, phi_o``: angles to the normal and azimuths of the light (i) and of the
  viewer (o); the mirror direction is at phi_o - phi_i = 180°, and a theta below 0 is on the other
  side of the normal;
- ``theta_i, theta_o, delta_phi``: delta_phi is phi_o - phi_i;
- ``theta_h, [phi_h,] theta_d, phi_d``: the half and difference angles of [Rusinkiewicz 1998];
- ``wi_x, wi_y, wi_z, wo_x, wo_y, wo_z``: unit vectors, z along the normal.

Angles are in degrees, or in the unit behind the name: ``theta_i [rad]``. Where all thetas are so
small that they might be in radians, the unit has to stand there.

Values: ``R, G, B`` (linear sRGB), or wavelengths such as ``550nm`` or ``550``, or one column
``BRDF``, in sr⁻¹. Columns ``CCBRDF``, ``CCBRDF_R`` or ``CCBRDF_550nm`` hold the cosine-corrected
BRDF of ASTM E2387, the BRDF times cos theta_o: the cosine is divided out. It is never guessed;
`brdfkit info` says where values of another name seem to have it, and ``--divide-by-cos`` divides it
out. Standard errors: ``R_error``, ``550nm_error``, ``BRDF_error``, ``CCBRDF_error`` or
``standard_error``. An empty field, NA, #N/A or - is a value that was not measured; a column without
a name is left out.

Wavelengths may stand in rows: beside one column ``BRDF`` or ``CCBRDF``, a column ``wavelength`` or
``lambda`` [nm], or ``channel`` with R, G or B. Rows with directions that are equal to 0.006° are
one sample.

Semicolons, commas, tabs or blanks separate the columns. Numbers may have decimal commas where the
separator is no comma, or in quotes. Lines that begin with # are comments: ``# key: text`` becomes a
note, and ``# anisotropic: yes`` or ``no`` says whether the BRDF changes as the surface turns.
Without this comment it does where the azimuth of the light, or of the half vector, varies. The
names of the columns may stand in the last comment, too.

A written file has the valid samples, or the cells of a table, with all digits of values and
standard errors; directions come back to 3e-15. It does not hold the values between the samples that
a format defines by its own interpolation.
"""

import re
from typing import IO

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.materials.formats._delimited import find_delimiter, read_columns, split_fields
from brdfkit.materials.formats._source import Source
from brdfkit.materials.formats._writing import compute_angles, require_measured, wrong_channels
from brdfkit.materials.measured import Measured
from brdfkit.materials.measured.column_names import are_sample_columns, parse_layout
from brdfkit.materials.measured.columns import to_sample_arguments
from brdfkit.materials.measured.coordinates import ANGLES
from brdfkit.materials.measured.spectrum_to_rgb import has_wavelengths
from brdfkit.materials.measured.validation import Origin

NAME = "CSV"
SUFFIXES = (".csv",)

NOTE = re.compile(r"([^:]{1,40}):\s+(.+)")  # a comment that becomes a note
ANISOTROPIC = {"yes": True, "no": False}
CONVENTION = (
    "BRDF in 1/sr, without a cosine; theta from the normal; i to the light, o to the viewer; the "
    "mirror direction is at phi_o = phi_i + 180 deg"
)


def sniff(head: bytes) -> bool:
    """Return whether a line of `head`, without tabs, names columns that give both directions."""
    return find_delimiter(head) not in (None, "\t")


def read(source: Source, name: str = NAME) -> Measured:
    """Read the samples as a `Measured`; `name` is the name of the format.

    Raises `BrdfkitError` for columns that are unknown, twice or missing, a row with other columns,
    text among numbers, angles that are impossible, and where their unit is not certain.
    """
    names, lines, columns = read_columns(source)
    details = to_sample_arguments(names, columns, None, Origin(str(source.path), lines))
    notes = _read_notes(source)
    if "anisotropic" in notes:
        stated = notes.pop("anisotropic").lower()
        if stated not in ANISOTROPIC:
            raise source.error(f"says 'anisotropic: {stated[:20]}', where yes or no belongs")
        details["anisotropic"] = ANISOTROPIC[stated]
    notes.pop("format", None)  # replaced by the name of this format
    details["info"] = {"format": name, **notes, **details["info"]}
    return source.build_from_directions(**details)


def write(obj: object, stream: IO[bytes], name: str = NAME, delimiter: str = ",") -> None:
    """Write the valid samples of a `Measured`, in its own channels.

    `name` is the name of the format.
    """
    data = require_measured(obj, name, anisotropic=True)
    headings = _name_values(data, name)
    samples, errors = data.samples.at(data.samples.valid), data.standard_error
    columns = [*_round(np.degrees(compute_angles(samples))), *samples.values.T]
    names = [*(f"{angle} [deg]" for angle in ANGLES), *headings]
    if errors is not None:
        columns += [*errors[data.samples.valid].T]
        names += [f"{heading}_error" for heading in headings]
    notes = {"convention": CONVENTION, **data.info, "name": data.name}
    notes["anisotropic"] = "yes" if data.anisotropic else "no"
    notes.pop("format", None)
    comments = [f"# {key}: {' '.join(note.split())}" for key, note in notes.items()]
    for line in (*comments, delimiter.join(names)):
        stream.write(f"{line}\n".encode(errors="replace"))
    for row in zip(*(column.tolist() for column in columns), strict=True):
        stream.write(f"{delimiter.join(map(repr, row))}\n".encode())


def _read_notes(source: Source) -> dict[str, str]:
    """Return the comments by their keys; comments without a key become the note "comment"."""
    notes, others = {}, []
    for comment in source.comments:
        note = NOTE.fullmatch(comment)
        if note:
            notes[note[1]] = note[2]
        elif comment and not are_sample_columns(split_fields(comment)):
            others.append(comment)
    return notes | ({"comment": "; ".join(others)} if others else {})


def _name_values(data: Measured, name: str) -> list[str]:
    """Return names of columns that `read` understands as the channels of a `Measured`."""
    one = len(data.channels) == 1 and not has_wavelengths(data)
    names = ["BRDF"] if one else list(data.channels)
    try:
        if len(parse_layout([*ANGLES, *names], Origin(data.name)).values) == len(names):
            return names
    except BrdfkitError:
        pass  # its sentence would speak of columns, where there are channels
    holds = "R, G, B, or wavelengths of 100 to 100,000 nm, each once, or one channel"
    raise wrong_channels(data, name, holds)


def _round(degrees: FloatArray) -> FloatArray:
    """Round angles to 12 decimals where this changes them by less than 1e-13.

    A file then has 30, not 30.000000000000004.
    """
    rounded = np.round(degrees, 12)
    return np.where(np.abs(rounded - degrees) < 1e-13, rounded, degrees)
