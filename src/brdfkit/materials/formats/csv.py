"""Tables of text with named columns, `.csv`, as spreadsheets, pandas and goniometers write them.

One line names the columns, in any order, and every line below it is a sample. Lines of text above
it are ignored, and a line below it may state the units. Directions are given by one of these sets
of columns:

- ``theta_i, phi_i, theta_o, phi_o``: angles to the normal and azimuths of the light (i) and of the
  viewer (o); the mirror direction is at phi_o - phi_i = 180°, and a theta below 0 is on the other
  side of the normal;
- ``theta_i, theta_o, delta_phi``: delta_phi is phi_o - phi_i;
- ``theta_h, [phi_h,] theta_d, phi_d``: the half and difference angles of [Rusinkiewicz 1998];
- ``wi_x, wi_y, wi_z, wo_x, wo_y, wo_z``: unit vectors, z along the normal.

Angles are in degrees, or in the unit behind the name: ``theta_i [rad]``. The unit must be stated
where all thetas are so small that they might be in radians.

Values [sr⁻¹] are columns ``R, G, B`` in linear sRGB, or wavelengths such as ``550nm`` or ``550``,
or one column ``BRDF``. Columns ``CCBRDF``, ``CCBRDF_R`` or ``CCBRDF_550nm`` contain the
cosine-corrected BRDF of ASTM E2387, the BRDF times cos theta_o, and are divided by this cosine.
Columns with other names are not: `brdfkit info` says where such values seem to contain the cosine,
and ``--divide-by-cos`` divides by it. Standard errors are columns ``R_error``, ``550nm_error``,
``BRDF_error``, ``CCBRDF_error`` or ``standard_error``. An empty field, NA, #N/A or - is a value
that was not measured. A column without a name is ignored.

Each row may also contain the value of a single channel. Beside one column ``BRDF`` or ``CCBRDF``
there is then a column ``wavelength`` or ``lambda`` [nm], or a column ``channel`` with R, G or B.
Rows whose directions differ by less than 0.006° are one sample.

Semicolons, commas, tabs or blanks separate the columns. Numbers may have decimal commas where the
separator is no comma, or in quotes. Lines that begin with # are comments: ``# key: text`` becomes a
note, and ``# anisotropic: yes`` or ``no`` says whether the BRDF changes as the surface turns.
Without this comment it does where the azimuth of the light, or of the half vector, varies. The
names of the columns may also stand in the last comment.

A written file has the valid samples, or the cells of a table, with all digits of values and
standard errors; directions are accurate to 3e-15. Values that the format of the original file
interpolates between its samples are lost.
"""

import re
from typing import IO

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.materials.formats._delimited import detect_delimiter, read_columns, split_fields
from brdfkit.materials.formats._source import Source
from brdfkit.materials.formats._writing import compute_angles, make_channel_error, require_measured
from brdfkit.materials.measured import Measured
from brdfkit.materials.measured.column_names import TASK, are_sample_columns, parse_layout
from brdfkit.materials.measured.columns import to_sample_arguments
from brdfkit.materials.measured.coordinates import ANGLES
from brdfkit.materials.measured.spectrum_to_rgb import has_wavelengths
from brdfkit.materials.measured.validation import Origin

NAME = "CSV"
SUFFIXES = (".csv",)

NOTE = re.compile(r"([^:]{1,40}):\s+(.+)")  # the form of a comment "key: text" that becomes a note
ANISOTROPIC = {"yes": True, "no": False}
CONVENTION = (
    "BRDF in 1/sr, without a cosine; theta from the normal; i to the light, o to the viewer; the "
    "mirror direction is at phi_o = phi_i + 180 deg"
)


def sniff(head: bytes) -> bool:
    """Return whether a file that begins with `head` is a table of BRDF samples without tabs."""
    return detect_delimiter(head) not in (None, "\t")


def read(source: Source, name: str = NAME) -> Measured:
    """Read a table of named columns as a `Measured`; `name` is the name of the format.

    Raises `BrdfkitError` for columns that are unknown, repeated or missing, for a row with another
    number of columns or with text among numbers, and for angles that are impossible or whose unit
    is uncertain.
    """
    names, lines, columns = read_columns(source)
    details = to_sample_arguments(names, columns, None, Origin(str(source.path), lines))
    empty = np.isnan(details["values"]).all(axis=0)
    if empty.any():
        channels = ", ".join(np.array(details["channels"])[empty])
        raise source.error(f"all fields of {channels} are empty; fill in what was measured")
    notes = _read_notes(source)
    if "anisotropic" in notes:
        stated = notes.pop("anisotropic").lower()
        if stated not in ANISOTROPIC:
            raise source.error(f"says 'anisotropic: {stated[:20]}', where yes or no belongs")
        details["anisotropic"] = ANISOTROPIC[stated]
    notes.pop("format", None)  # the format of the original file, if this one was converted from it
    details["info"] = {"format": name, **notes, **details["info"]}
    return source.make_measured_from_directions(**details)


def write(obj: object, stream: IO[bytes], name: str = NAME, delimiter: str = ",") -> None:
    """Write the valid samples of a `Measured` as a table of named columns, in its own channels.

    `name` is the name of the format, and `delimiter` separates the columns.
    """
    data = require_measured(obj, name, anisotropic=True)
    headings = _name_value_columns(data, name)
    samples, errors = data.samples.at(data.samples.valid), data.standard_error
    columns = [*_round_angles(np.degrees(compute_angles(samples))), *samples.values.T]
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
    """Return the file's comments as notes by their keys; those without a key become "comment"."""
    notes, others = {}, []
    for comment in source.comments:
        note = NOTE.fullmatch(comment)
        if note:
            notes[note[1]] = note[2]
        elif comment and comment != TASK and not are_sample_columns(split_fields(comment)):
            others.append(comment)
    return notes | ({"comment": "; ".join(others)} if others else {})


def _name_value_columns(data: Measured, name: str) -> list[str]:
    """Return column names for the channels of a `Measured` that `read` understands.

    Raises `BrdfkitError` where the format `name` has none.
    """
    one = len(data.channels) == 1 and not has_wavelengths(data)
    names = ["BRDF"] if one else list(data.channels)
    try:
        if len(parse_layout([*ANGLES, *names], Origin(data.name)).values) == len(names):
            return names
    except BrdfkitError:
        pass  # raise an error about the material's channels below, in place of one about columns
    holds = "R, G, B, or wavelengths of 100 to 100,000 nm, each once, or one channel"
    raise make_channel_error(data, name, holds)


def _round_angles(degrees: FloatArray) -> FloatArray:
    """Round angles to 12 decimals where this is a rounding error: 30 for 30.000000000000004."""
    rounded = np.round(degrees, 12)
    return np.where(np.abs(rounded - degrees) < 1e-13, rounded, degrees)
