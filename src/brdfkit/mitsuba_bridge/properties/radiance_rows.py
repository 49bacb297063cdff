"""Checks the packed rows of a Radiance file (.hdr), which Mitsuba 3.9 does not check.

A packed row begins with the bytes 2 and 2, and its length in two bytes. Then come all bytes of R,
of G, of B and of the exponent, in runs. A byte n > 128 means that the next byte occurs n - 128
times, a byte n ≤ 128 that the next n bytes are not packed [Ward 1991].
"""

import re
from os import PathLike

from brdfkit.core.errors import BrdfkitError

SIZE = re.compile(rb"\n\n-Y (\d+) \+X (\d+)\n")
NARROWEST, WIDEST = 8, 32767  # lengths of rows [pixels]; shorter and longer rows are not packed


def require_intact_rows(path: str | PathLike[str], name: object) -> None:
    """Raise `BrdfkitError`, which calls the file `name`, for a Radiance file with damaged rows.

    Files of other kinds, and files without packed rows, are not checked.
    """
    with open(path, "rb") as stream:
        if stream.read(2) != b"#?":
            return
        data = b"#?" + stream.read()
    size = SIZE.search(data)
    height, width = map(int, size.groups()) if size else (0, 0)
    if not size or not NARROWEST <= width <= WIDEST or not _is_packed(data, size.end(), width):
        return  # Mitsuba reads such a file pixel by pixel, and reports what is wrong
    at = size.end()
    try:
        for row in range(height):
            end = _find_row_end(data, at, width)
            if end is None:
                raise BrdfkitError(f"{name}: its row {row + 1} is damaged.")
            at = end
    except IndexError:
        raise BrdfkitError(f"{name}: it is cut short, in row {row + 1} of {height}.") from None


def _is_packed(data: bytes, at: int, width: int) -> bool:
    """Return whether a packed row of this width begins at the position `at`."""
    return data[at : at + 4] == bytes((2, 2, width >> 8, width & 255))


def _find_row_end(data: bytes, at: int, width: int) -> int | None:
    """Return the end of the packed row at the position `at`, None for a damaged row."""
    if not _is_packed(data, at, width):
        data[at + 3]  # raises an IndexError where the file ends
        return None
    at += 4
    for _ in range(4):
        left = width
        while left > 0:
            count = data[at]
            if count > 128:
                left, at = left - count + 128, at + 2
            else:
                left, at = left - count, at + 1 + count
            if count == 0:
                return None
        if left:
            return None
    data[at - 1]
    return at
