"""The CUReT database in one file, `abrdf.dat`: 61 materials at 205 pairs of directions.

[Dana et al. 1999] measured them, and averaged the values over R, G and B. A row of `abrdf.dat` has
the number of a material and its values [sr⁻¹]. The file `table.txt` in the same folder has the
pairs of directions: their number and the angles theta_v, phi_v, theta_i, phi_i [rad], first of the
view (v), then of the light (i).
"""

from brdfkit.materials.formats._source import Source
from brdfkit.materials.measured import Measured

NAME = "CUReT"
SUFFIXES = (".dat",)
MANY = True

SAMPLES = 61
GEOMETRIES = 205
TABLE = "table.txt"


def sniff(head: bytes) -> bool:
    """Return whether a file that begins with `head` is CUReT's, by the 206 numbers in a line."""
    fields = head.lstrip().split(b"\n", 1)[0].split()
    try:
        return len(list(map(float, fields))) == 1 + GEOMETRIES and fields[0].isdigit()
    except ValueError:
        return False


def read(source: Source) -> Measured:
    """Read one material, named as in ``abrdf.dat#1``, as a `Measured` with the one channel Y.

    Raises `BrdfkitError` when none is named, `table.txt` is missing, or a file has another number
    of rows or columns.
    """
    rows = _read_numbered_rows(source, SAMPLES, GEOMETRIES)
    sample = _parse_sample_number(source)
    table = source.open_sibling(TABLE)
    theta_v, phi_v, theta_i, phi_i = zip(*_read_numbered_rows(table, GEOMETRIES, 4), strict=True)
    angles = list(zip(theta_i, phi_i, theta_v, phi_v, strict=True))
    lines = [n for n, _ in table.lines]
    info = {
        "format": NAME,
        "sample": str(sample),
        "channels": "Y is the mean of R, G and B",
        "overexposed": "entries that were overexposed are not marked in the file",
    }
    values = [[value] for value in rows[sample - 1]]
    name = f"CUReT {sample}"
    return table.make_measured_from_angles(
        lines, angles, values, channels=("Y",), name=name, info=info
    )


def _parse_sample_number(source: Source) -> int:
    """Return the material's number behind '#' in the path; raise `BrdfkitError` if it is none."""
    number = source.sample or ""
    if number.isascii() and number.isdecimal() and 1 <= int(number[:9]) <= SAMPLES:
        return int(number[:9])
    stated = f", not '#{number[:20]}'" if number else ""
    raise source.error(
        f"holds {SAMPLES} samples; name one of 1 to {SAMPLES}{stated}, as in '{source.path.name}#1'"
    )


def _read_numbered_rows(source: Source, count: int, columns: int) -> list[list[float]]:
    """Return the numbers of each of `count` rows, without the first one, the row's number."""
    rows = [source.parse_numbers(n, line.split(), 1 + columns) for n, line in source.lines]
    if [row[0] for row in rows] != list(range(1, count + 1)):
        raise source.error(
            f"has {len(rows)} rows where {count} belong, numbered from 1; fetch the file again"
        )
    return [row[1:] for row in rows]
