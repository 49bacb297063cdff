"""Reads and writes tensor files: the container of RGL's files, which holds named arrays.

Mitsuba's `TensorFile` defines it. A file is little-endian and has ``tensor_file\\0``, the version
(two uint8) and the number of fields (uint32). For each field follow the length of its name
(uint16), its name, number of dimensions (uint16), type (uint8), offset (uint64) and dimensions
(uint64 each). Then come the data.
"""

import math
import struct
from collections.abc import Mapping, Sequence
from typing import IO, Any

import numpy as np

from brdfkit.core.array_types import AnyArray
from brdfkit.materials.formats._source import Source

MAGIC = b"tensor_file\0"
VERSION = 1, 0
ALIGNMENT = 8
MOST_DIMENSIONS = 8
# The types that an array may have: a file states them by their place in this list, counted from 1
TYPES = [np.dtype(f"<{kind}{size}") for size in (1, 2, 4, 8) for kind in "ui"]
TYPES += [np.dtype(f"<f{size}") for size in (2, 4, 8)]
REMEDY = "fetch the file again"


def read(source: Source) -> dict[str, AnyArray]:
    """Return the arrays of a tensor file by name.

    They are views of the file's bytes, so that no header can demand memory. Raises `BrdfkitError`
    if a field is cut off, is repeated, or has an unknown type.
    """
    header = _Cursor(source)
    if header.read_bytes(len(MAGIC)) != MAGIC or header.read_numbers("<BB") != VERSION:
        raise source.error("is no tensor file of version 1.0; check that it is an RGL file")
    fields: dict[str, AnyArray] = {}
    (count,) = header.read_numbers("<I")
    for _ in range(count):
        name = header.read_bytes(*header.read_numbers("<H")).decode(
            "utf-8", errors="backslashreplace"
        )[:40]
        if name in fields:
            raise source.error(f"has the field {name!r} twice; {REMEDY}")
        dimensions, number, offset = header.read_numbers("<HBQ")
        if not 1 <= dimensions <= MOST_DIMENSIONS:
            raise source.error(f"field {name!r} has {dimensions} dimensions; {REMEDY}")
        shape = header.read_numbers(f"<{dimensions}Q")
        fields[name] = _view_array(source, name, number, offset, shape)
    return fields


def write(stream: IO[bytes], fields: Mapping[str, AnyArray]) -> None:
    """Write a tensor file with the named arrays `fields` to a binary stream, in their order."""
    arrays = {name.encode(): np.ascontiguousarray(array) for name, array in fields.items()}
    sizes = (2 + len(name) + 2 + 1 + 8 + 8 * array.ndim for name, array in arrays.items())
    end = len(MAGIC) + 2 + 4 + sum(sizes)
    header, body = [MAGIC, struct.pack("<BBI", *VERSION, len(arrays))], []
    for name, array in arrays.items():
        padding = -end % ALIGNMENT
        number = 1 + TYPES.index(array.dtype)
        header += [struct.pack("<H", len(name)), name]
        header.append(struct.pack("<HBQ", array.ndim, number, end + padding))
        header.append(struct.pack(f"<{array.ndim}Q", *array.shape))
        body += [bytes(padding), array.tobytes()]
        end += padding + array.nbytes
    for part in (*header, *body):
        stream.write(part)


def format_shape(shape: Sequence[int]) -> str:
    """Return the shape of an array as text, such as 3×4."""
    return "×".join(map(str, shape))


def _view_array(
    source: Source, name: str, number: int, offset: int, shape: Sequence[int]
) -> AnyArray:
    """Return the array `name` at byte `offset`; `number` stands for its type in the file."""
    if not 1 <= number <= len(TYPES):
        raise source.error(f"field {name!r} has the unknown type {number}; {REMEDY}")
    dtype, size = TYPES[number - 1], math.prod(shape)
    if size == 0:
        raise source.error(f"field {name!r} is empty; {REMEDY}")
    if offset + size * dtype.itemsize > len(source.data):
        raise source.error(
            f"field {name!r}, {format_shape(shape)[:60]} numbers from byte {offset:,} on, "
            f"is not within the {len(source.data):,} bytes of the file (cut short?); {REMEDY}"
        )
    return np.frombuffer(source.data, dtype, size, offset).reshape(shape)


class _Cursor:
    """Reads the header of a file step by step, and keeps the position in its bytes."""

    def __init__(self, source: Source) -> None:
        self.source, self.position = source, 0

    def read_bytes(self, count: int) -> bytes:
        """Read the next `count` bytes; raise `BrdfkitError` at the end of the file."""
        start, self.position = self.position, self.position + count
        if self.position > len(self.source.data):
            raise self.source.error(
                f"ends within its list of fields, at byte {len(self.source.data):,}; {REMEDY}"
            )
        return self.source.data[start : self.position]

    def read_numbers(self, layout: str) -> tuple[Any, ...]:
        """Read the next numbers, whose types `layout` gives in the notation of `struct`."""
        return struct.unpack(layout, self.read_bytes(struct.calcsize(layout)))
