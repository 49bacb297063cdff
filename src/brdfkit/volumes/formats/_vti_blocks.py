"""The data of VTK's XML files: text, or bytes that may be packed by zlib, raw or in base64.

Plain bytes are preceded by their number. Packed bytes are preceded by the number of blocks, the
size of a block, the size of the last block if it is smaller, and the packed size of each block.
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

from brdfkit.volumes.formats._streams import DType, Opener, parse_numbers, require_bytes
from brdfkit.volumes.formats._volume_file import Shape, VolumeFile

ZLIB = "vtkZLibDataCompressor"


@dataclass(frozen=True)
class Encoding:
    """The encoding of a file's data: `form` is "ascii", "base64" or "raw".

    `size_type` is the type of the numbers of bytes, `packed` says whether zlib has packed the data.
    """

    form: str
    byte_order: Literal["<", ">"]
    size_type: DType
    packed: bool

    @classmethod
    def read(
        cls, file: VolumeFile, root: Element, form: str | None, appended: str | None
    ) -> Encoding:
        """Read the encoding from the root of the XML and the format `form` of the array.

        `appended` is the form of appended data.
        """
        compressor = root.get("compressor")
        if compressor not in (None, ZLIB):
            raise file.error(f"is packed by {compressor}, which is not read; save it with zlib")
        order: Literal["<", ">"] = ">" if root.get("byte_order") == "BigEndian" else "<"
        size_type = {"UInt32": "u4", "UInt64": "u8"}.get(root.get("header_type", "UInt32"))
        forms = {"appended": appended, "ascii": "ascii", "binary": "base64"}
        form = None if form is None else forms.get(form)
        if form is None or size_type is None:
            raise file.error("its header is damaged (format or header_type); fetch it again")
        return cls(form, order, np.dtype(order + size_type), compressor is not None)


def make_opener(
    file: VolumeFile, start: int, stop: int, encoding: Encoding, shape: Shape, dtype: DType
) -> Opener:
    """Return a function that opens the stream of the voxels between two places of a file.

    Raises `BrdfkitError` at once if there is no room for the voxels.
    """
    is_text = encoding.form == "ascii"
    smallest = np.dtype(np.uint8) if is_text else dtype  # a number has at least one digit
    require_bytes(file, file.path, start, shape, smallest, "zlib" if encoding.packed else "")

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
                else skip_size(stream, encoding, size, room)
            )

    return open_stream


class Base64Stream:
    """A stream of the bytes that are written in base64 in another stream.

    It never reads more letters than the bytes need, because other data may follow. The number of
    bytes, which is encoded separately, ends with its padding.
    """

    def __init__(self, text: Any) -> None:
        self.text, self.ready = text, b""

    def read(self, size: int) -> bytes:
        """Read the next `size` bytes, or fewer at the end."""
        triples = -(-(size - len(self.ready)) // 3)
        data = self.ready + _decode(self._read_letters(4 * max(triples, 0)))
        self.ready = data[size:]
        return data[:size]

    def _read_letters(self, count: int) -> bytes:
        """Read the next `count` letters, without blanks and line breaks."""
        parts: list[bytes] = []
        while count > 0 and (data := self.text.read(count)):
            parts += data.split()
            count -= sum(map(len, data.split()))
        return b"".join(parts)


class PackedStream:
    """A stream of `expected` bytes in blocks packed by zlib, within `room` bytes of the file."""

    def __init__(self, stream: Any, encoding: Encoding, expected: int, room: int) -> None:
        self.stream, self.ready = stream, b""
        count, block, last = _read_sizes(stream, encoding, 3, room)
        _require_size((count - bool(last)) * block + last, expected)
        packed_sizes = _read_sizes(stream, encoding, count, room)
        if sum(packed_sizes) > room:
            raise EOFError
        self.packed_sizes, self.block_size = iter(packed_sizes), min(block, expected)

    def read(self, size: int) -> bytes:
        """Read the next `size` bytes, or fewer at the end."""
        parts, missing = [self.ready], size - len(self.ready)
        while missing > 0 and (packed := next(self.packed_sizes, 0)):
            unpacker = zlib.decompressobj()
            parts.append(unpacker.decompress(self.stream.read(packed), self.block_size))
            missing -= len(parts[-1])
        data = b"".join(parts)
        self.ready = data[size:]
        return data[:size]


def skip_size(stream: Any, encoding: Encoding, expected: int, room: int) -> Any:
    """Read the number of bytes, which should be the `expected` one, and return the stream."""
    (size,) = _read_sizes(stream, encoding, 1, room)
    _require_size(size, expected)
    return stream


def _read_sizes(stream: Any, encoding: Encoding, count: int, room: int) -> list[int]:
    """Read `count` numbers of bytes; raise EOFError if they need more than `room` bytes."""
    needed = count * encoding.size_type.itemsize
    data = stream.read(needed) if needed <= room else b""
    if len(data) < needed:
        raise EOFError
    sizes: list[int] = np.frombuffer(data, encoding.size_type).tolist()
    return sizes


def _require_size(size: int, expected: int) -> None:
    """Raise EOFError unless a number of bytes is the `expected` one."""
    if size != expected:
        raise EOFError(f"{size:,} bytes where the extent needs {expected:,}")


def _decode(letters: bytes) -> bytes:
    """Decode base64; raise EOFError if it is damaged."""
    try:
        return base64.b64decode(letters, validate=True)
    except ValueError as error:
        raise EOFError from error
