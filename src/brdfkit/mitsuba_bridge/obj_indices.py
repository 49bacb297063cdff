"""Rewrites OBJ meshes with relative indices, -1 for the last vertex, for Mitsuba."""

import re
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

RELATIVE = re.compile(rb"(?<![^\s/])-[0-9]+")
FACE = re.compile(rb"^[ \t]*f\s.*-", re.MULTILINE)
ELEMENTS = b"v", b"vt", b"vn"  # in the order of a corner: vertex/texture/normal


@contextmanager
def use_absolute_indices(path: Path) -> Iterator[Path]:
    """Yield the path of a mesh without relative indices: the file itself, or a temporary copy."""
    data = path.read_bytes()
    if path.suffix.lower() != ".obj" or not FACE.search(data):
        yield path
        return
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder, "mesh.obj")
        copy.write_bytes(b"\n".join(_make_lines_absolute(data.splitlines())))
        yield copy


def _make_lines_absolute(lines: Iterable[bytes]) -> Iterator[bytes]:
    """Yield the lines of an OBJ with indices that count from 1, instead of backwards from -1."""
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


def _make_corner_absolute(corner: bytes, counts: Iterable[int]) -> bytes:
    """Return a corner of a face, such as b"-1/-1", with indices from 1.

    An index before the first element becomes 0, which Mitsuba refuses.
    """
    indices = zip(corner.split(b"/"), counts, strict=False)
    return b"/".join(
        b"%d" % max(int(i) + count + 1, 0) if RELATIVE.fullmatch(i) else i for i, count in indices
    )
