"""Checks the packed rows of a Radiance file (.hdr): in wrong ones Mitsuba 3.9 leaves its memory.

A row is 2, 2 and its length in two bytes, then for each of R, G, B and the exponent runs: n > 128
and a byte stand for n - 128 of them, n ≤ 128 and n bytes for these [Ward 1991].
"""

import re

from brdfkit.core.errors import BrdfkitError

SIZE = re.compile(rb"\n\n-Y (\d+) \+X (\d+)\n")
NARROWEST, WIDEST = 8, 32767  # rows of another length are not packed


def require_rows(path, name):
    """Raise `BrdfkitError`, which calls it `name`, for a Radiance file whose rows are not all
    packed, or not to their end; of a file of another kind, nothing is said."""
    with open(path, "rb") as stream:
        if stream.read(2) != b"#?":
            return
        data = b"#?" + stream.read()
    size = SIZE.search(data)
    height, width = map(int, size.groups()) if size else (0, 0)
    if not size or not NARROWEST <= width <= WIDEST or not _is_packed(data, size.end(), width):
        return  # Mitsuba reads such a file pixel by pixel, and tells what is wrong
    at = size.end()
    try:
        for row in range(height):
            at = _find_row_end(data, at, width)
            if at is None:
                raise BrdfkitError(f"{name}: its row {row + 1} is damaged.")
    except IndexError:
        raise BrdfkitError(f"{name}: it is cut short, in row {row + 1} of {height}.") from None


def _is_packed(data, at, width):
    """Whether a packed row of this width begins there."""
    return data[at : at + 4] == bytes((2, 2, width >> 8, width & 255))


def _find_row_end(data, at, width):
    """Where the row that begins there ends; None for one that is not packed or damaged."""
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
