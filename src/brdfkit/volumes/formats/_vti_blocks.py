"""Decoding of the data arrays in VTK's XML files: text, or binary data, raw or in base64.

The number of bytes precedes plain binary data. Data that zlib has packed in blocks are preceded by
the number of blocks, the size of a block, the size of the last block if it is smaller, and the
packed size of each block.
"""

from __future__ import annotations

import base64
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from math import prod
from typing import Any, Literal
from xml.etree.ElementTree import Element

import numpy as np

from brdfkit.volumes.formats._streams import DType, Opener, parse_numbers, require_enough_bytes
from brdfkit.volumes.formats._volume_file import Shape, VolumeFile

ZLIB = "vtkZLibDataCompressor"


@dataclass(frozen=True)
class Encoding:
    """The encoding of a data array in one of VTK's XML files.

    `form` is "ascii", "base64" or "raw", `byte_order` the order of bytes in a number, and
    `size_type` the integer type of the byte counts that precede data. `packed` says whether zlib
    has packed the data.
    """

    form: str
    byte_order: Literal["<", ">"]
    size_type: DType
    packed: bool

    @classmethod
    def read(
        cls, file: VolumeFile, root: Element, form: str | None, appended: str | None
    ) -> Encoding:
        """Read the encoding of an array from the attributes of the XML's root element.

        `form` is the array's attribute "format". `appended` is "raw" or "base64", the form of the
        data at the end of the file, or None if there are none.
        """
        compressor = root.get("compressor")
        if compressor not in (None, ZLIB):
            raise file.error(f"is packed by {compressor}, which is not read; save it with zlib")
        order: Literal["<", ">"] = ">" if root.get("byte_order") == "BigEndian" else "<"
        size_type = {"UInt32": "u4", "UInt64": "u8"}.get(root.get("header_type", "UInt32"))
        forms = {"appended": appended, "ascii": "ascii", "binary": "base64"}
        form = None if form is None else forms.get(form)
        if form is None or size_type is None:
            raise file.error(
                "its header is damaged (format or header_type); save or fetch it again"
            )
        return cls(form, order, np.dtype(order + size_type), compressor is not None)


def make_opener(
    file: VolumeFile, start: int, stop: int, encoding: Encoding, shape: Shape, dtype: DType
) -> Opener:
    """Return a function that opens a stream of the voxels from byte `start` to `stop` of a file.

    Raises `BrdfkitError` at once if there are too few bytes for voxels of this `shape` and `dtype`.
    """
    is_text = encoding.form == "ascii"
    smallest = np.dtype(np.uint8) if is_text else dtype  # a number as text has one byte or more
    require_enough_bytes(file, file.path, start, shape, smallest, "zlib" if encoding.packed else "")

    @contextmanager
    def open_stream() -> Iterator[Any]:
        with file.path.open("rb") as raw:
            raw.seek(start)
            if is_text:
                yield parse_numbers(raw.read(stop - start), dtype)
                return
            stream: Any = raw if encoding.form == "raw" else Base64Stream(raw)
            size = prod(shape) * dtype.itemsize
            room = stop - start
            yield (
                PackedStream(stream, encoding, size, room)
                if encoding.packed
                else skip_byte_count(stream, encoding, size, room)
            )

    return open_stream


class Base64Stream:
    """A stream of bytes, decoded from the base64 letters of another stream.

    It never reads more letters than the bytes need, because other data may follow. VTK encodes the
    byte counts separately from the data, so that padding letters lie between the two.
    """

    def __init__(self, text: Any) -> None:
        self.text, self.ready = text, b""

    def read(self, size: int) -> bytes:
        """Read the next `size` decoded bytes, or fewer at the end."""
        triples = -(-(size - len(self.ready)) // 3)
        data = self.ready + _decode_base64(self._read_base64_letters(4 * max(triples, 0)))
        self.ready = data[size:]
        return data[:size]

    def _read_base64_letters(self, count: int) -> bytes:
        """Read the next `count` base64 letters, and skip blanks and line breaks."""
        parts: list[bytes] = []
        while count > 0 and (data := self.text.read(count)):
            parts += data.split()
            count -= sum(map(len, data.split()))
        return b"".join(parts)


class PackedStream:
    """A stream that unpacks a data array of VTK's, `expected` bytes in blocks packed by zlib.

    The packed blocks must fit into `room` bytes of the file; otherwise EOFError is raised.
    """

    def __init__(self, stream: Any, encoding: Encoding, expected: int, room: int) -> None:
        self.stream, self.ready = stream, b""
        count, block, last = _read_byte_counts(stream, encoding, 3, room)
        _require_byte_count((count - bool(last)) * block + last, expected)
        packed_sizes = _read_byte_counts(stream, encoding, count, room)
        if sum(packed_sizes) > room:
            raise EOFError
        self.packed_sizes, self.block_size = iter(packed_sizes), min(block, expected)

    def read(self, size: int) -> bytes:
        """Read the next `size` unpacked bytes, or fewer at the end."""
        parts, missing = [self.ready], size - len(self.ready)
        while missing > 0 and (packed := next(self.packed_sizes, 0)):
            unpacker = zlib.decompressobj()
            parts.append(unpacker.decompress(self.stream.read(packed), self.block_size))
            missing -= len(parts[-1])
        data = b"".join(parts)
        self.ready = data[size:]
        return data[:size]


def skip_byte_count(stream: Any, encoding: Encoding, expected: int, room: int) -> Any:
    """Read the byte count before data that are not packed; return the stream at the first voxel.

    Raises EOFError unless the count is `expected`, and fits into the `room` [bytes] of the array.
    """
    (size,) = _read_byte_counts(stream, encoding, 1, room)
    _require_byte_count(size, expected)
    return stream


def _read_byte_counts(stream: Any, encoding: Encoding, count: int, room: int) -> list[int]:
    """Read `count` integers, the byte counts that precede the data of an array.

    Raises EOFError if the stream ends before, or if they need more than `room` bytes.
    """
    needed = count * encoding.size_type.itemsize
    data = stream.read(needed) if needed <= room else b""
    if len(data) < needed:
        raise EOFError
    sizes: list[int] = np.frombuffer(data, encoding.size_type).tolist()
    return sizes


def _require_byte_count(size: int, expected: int) -> None:
    """Raise EOFError unless an array has as many bytes, `size`, as its voxels need, `expected`."""
    if size != expected:
        raise EOFError(f"{size:,} bytes where the extent needs {expected:,}")


def _decode_base64(letters: bytes) -> bytes:
    """Decode base64 `letters` to bytes; raise EOFError if they are damaged."""
    try:
        return base64.b64decode(letters, validate=True)
    except ValueError as error:
        raise EOFError from error
