"""The data of VTK's XML files: plain text, or blocks, packed by zlib or not, raw or in base64.

Unpacked: the number of bytes, then the bytes. Packed: the number of blocks, the size of a block,
that of the last one if it is smaller, the packed size of each; then the packed blocks.
"""

import base64
import zlib
from contextlib import contextmanager
from dataclasses import dataclass
from math import prod

import numpy as np

from brdfkit.volumes.formats._streams import numbers_in, require_bytes

ZLIB = "vtkZLibDataCompressor"


@dataclass(frozen=True)
class Encoding:
    """How the data of a file are written: `form` is "ascii", "base64" or "raw"."""

    form: str
    byte_order: str
    size_type: np.dtype
    packed: bool

    @classmethod
    def of(cls, file, root, form, appended):
        """The encoding that the root of the XML and the format of the array tell."""
        compressor = root.get("compressor")
        if compressor not in (None, ZLIB):
            raise file.error(f"is packed by {compressor}, which is not read; save it with zlib")
        order = ">" if root.get("byte_order") == "BigEndian" else "<"
        size_type = {"UInt32": "u4", "UInt64": "u8"}.get(root.get("header_type", "UInt32"))
        form = {"appended": appended, "ascii": "ascii", "binary": "base64"}.get(form)
        if form is None or size_type is None:
            raise file.error("its header is damaged (format or header_type); fetch it again")
        return cls(form, order, np.dtype(order + size_type), compressor is not None)


def opener(file, start, stop, encoding, shape, dtype):
    """A function that opens the stream of the voxels between two places of a file.

    Raises `BrdfkitError`, before anything is read, where there is no room for them.
    """
    is_text = encoding.form == "ascii"
    least = np.uint8 if is_text else dtype  # a digit and a blank, or more
    require_bytes(file, file.path, start, shape, least, "zlib" if encoding.packed else "")

    @contextmanager
    def open_stream():
        with file.path.open("rb") as raw:
            raw.seek(start)
            if is_text:
                yield numbers_in(raw.read(stop - start), dtype)
                return
            stream = raw if encoding.form == "raw" else Base64(raw)
            size = prod(shape) * dtype.itemsize
            room = stop - start
            yield (
                Packed(stream, encoding, size, room)
                if encoding.packed
                else plain(stream, encoding, size, room)
            )

    return open_stream


class Base64:
    """A stream of what is written in base64 in another stream.

    It never reads more letters than the bytes need, as other data may follow; a number of bytes
    that was encoded by itself ends with its padding.
    """

    def __init__(self, text):
        self.text, self.ready = text, b""

    def read(self, size):
        """The next `size` bytes, fewer at the end."""
        triples = -(-(size - len(self.ready)) // 3)
        data = self.ready + _decoded(self._letters(4 * max(triples, 0)))
        self.ready = data[size:]
        return data[:size]

    def _letters(self, count):
        """The next `count` letters, without blanks and ends of lines."""
        parts = []
        while count > 0 and (data := self.text.read(count)):
            parts += data.split()
            count -= sum(map(len, data.split()))
        return b"".join(parts)


class Packed:
    """A stream of `expected` bytes in blocks that zlib packed, within `room` bytes of the file."""

    def __init__(self, stream, encoding, expected, room):
        self.stream, self.ready = stream, b""
        count, block, last = _sizes(stream, encoding, 3, room)
        _require((count - bool(last)) * block + last, expected)
        packed_sizes = _sizes(stream, encoding, count, room)
        if sum(packed_sizes) > room:
            raise EOFError
        self.packed_sizes, self.most = iter(packed_sizes), min(block, expected)

    def read(self, size):
        """The next `size` bytes, fewer at the end."""
        parts, missing = [self.ready], size - len(self.ready)
        while missing > 0 and (packed := next(self.packed_sizes, 0)):
            unpacker = zlib.decompressobj()
            parts.append(unpacker.decompress(self.stream.read(packed), self.most))
            missing -= len(parts[-1])
        data = b"".join(parts)
        self.ready = data[size:]
        return data[:size]


def plain(stream, encoding, expected, room):
    """The stream itself, behind its number of bytes, which is to be `expected`."""
    _require(*_sizes(stream, encoding, 1, room), expected)
    return stream


def _sizes(stream, encoding, count, room):
    needed = count * encoding.size_type.itemsize
    data = stream.read(needed) if needed <= room else b""
    if len(data) < needed:
        raise EOFError
    return np.frombuffer(data, encoding.size_type).tolist()


def _require(told, expected):
    if told != expected:
        raise EOFError(f"{told:,} bytes where the extent needs {expected:,}")


def _decoded(letters):
    try:
        return base64.b64decode(letters, validate=True)
    except ValueError as error:
        raise EOFError from error
