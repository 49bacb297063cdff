"""Meshes in OBJ that count vertices backwards, -1 for the last one, which Mitsuba does not read."""

import re
import tempfile
from contextlib import contextmanager
from pathlib import Path

RELATIVE = re.compile(rb"(?<![^\s/])-[0-9]+")
FACE = re.compile(rb"^[ \t]*f\s.*-", re.MULTILINE)
ELEMENTS = b"v", b"vt", b"vn"  # in the order of a corner: vertex/texture/normal


@contextmanager
def use_absolute_indices(path):
    """The `Path` of a mesh without relative indices: the file itself, or a temporary copy."""
    data = path.read_bytes()
    if path.suffix.lower() != ".obj" or not FACE.search(data):
        yield path
        return
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder, "mesh.obj")
        copy.write_bytes(b"\n".join(_make_lines_absolute(data.splitlines())))
        yield copy


def _make_lines_absolute(lines):
    """The lines of an OBJ with indices from 1: -1 is the last element before a face."""
    count = dict.fromkeys(ELEMENTS, 0)
    for line in lines:
        first, *corners = line.split() or [b""]
        if first in count:
            count[first] += 1
        if first == b"f":
            line = b"f " + b" ".join(
                _make_corner_absolute(corner, count.values()) for corner in corners
            )
        yield line


def _make_corner_absolute(corner, counts):
    """A corner of a face, as b"-1/-1"; an index before the first becomes 0, which is refused."""
    indices = zip(corner.split(b"/"), counts, strict=False)
    return b"/".join(
        b"%d" % max(int(i) + count + 1, 0) if RELATIVE.fullmatch(i) else i for i, count in indices
    )
