"""The container of RGL's files: named arrays, little-endian, as Mitsuba's `TensorFile` defines it.

``tensor_file\\0``, version (two uint8), number of fields (uint32); per field the length of its name
(uint16), name, number of dimensions (uint16), type (uint8), offset (uint64) and dimensions
(uint64 each); then the data.
"""

import math
import struct

import numpy as np

MAGIC = b"tensor_file\0"
VERSION = 1, 0
ALIGNMENT = 8
MOST_DIMENSIONS = 8
# in the order of their numbers, from 1
TYPES = [np.dtype(f"<{kind}{size}") for size in (1, 2, 4, 8) for kind in "ui"]
TYPES += [np.dtype(f"<f{size}") for size in (2, 4, 8)]
REMEDY = "fetch the file again"


def read(source):
    """The arrays of the `Source` by name: views, so that nothing is allocated by what it says.

    Raises `BrdfkitError` when a field is not wholly in the file, twice, or of an unknown type.
    """
    header = _Cursor(source)
    if header.bytes(len(MAGIC)) != MAGIC or header.numbers("<BB") != VERSION:
        raise source.error("is no tensor file of version 1.0; check that it is an RGL file")
    fields = {}
    (count,) = header.numbers("<I")
    for _ in range(count):
        name = header.bytes(*header.numbers("<H")).decode("utf-8", errors="backslashreplace")[:40]
        if name in fields:
            raise source.error(f"has the field {name!r} twice; {REMEDY}")
        dimensions, number, offset = header.numbers("<HBQ")
        if not 1 <= dimensions <= MOST_DIMENSIONS:
            raise source.error(f"field {name!r} has {dimensions} dimensions; {REMEDY}")
        shape = header.numbers(f"<{dimensions}Q")
        fields[name] = _array(source, name, number, offset, shape)
    return fields


def write(stream, fields):
    """Write arrays by name, in their order, to a binary stream."""
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


def _array(source, name, number, offset, shape):
    if not 1 <= number <= len(TYPES):
        raise source.error(f"field {name!r} has the unknown type {number}; {REMEDY}")
    dtype, size = TYPES[number - 1], math.prod(shape)
    if size == 0:
        raise source.error(f"field {name!r} is empty; {REMEDY}")
    if offset + size * dtype.itemsize > len(source.data):
        raise source.error(
            f"field {name!r}, {'×'.join(map(str, shape))[:60]} numbers from byte {offset:,} on, "
            f"is not within the {len(source.data):,} bytes of the file (cut short?); {REMEDY}"
        )
    return np.frombuffer(source.data, dtype, size, offset).reshape(shape)


class _Cursor:
    """Reads the header from the front."""

    def __init__(self, source):
        self.source, self.position = source, 0

    def bytes(self, count):
        start, self.position = self.position, self.position + count
        if self.position > len(self.source.data):
            raise self.source.error(
                f"ends within its list of fields, at byte {len(self.source.data):,}; {REMEDY}"
            )
        return self.source.data[start : self.position]

    def numbers(self, layout):
        return struct.unpack(layout, self.bytes(struct.calcsize(layout)))
