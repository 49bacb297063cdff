"""Reading of layers of voxels from streams of bytes, plain, compressed, or numbers as text."""

import bz2
import gzip
import io
import zlib
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from math import prod
from pathlib import Path
from typing import Any, BinaryIO, TypeAlias

import numpy as np

from brdfkit.core.array_types import AnyArray
from brdfkit.volumes.formats._volume_file import Shape, VolumeFile

DType: TypeAlias = np.dtype[Any]
Opener: TypeAlias = Callable[[], AbstractContextManager[Any]]  # opens a stream of bytes

CHUNK = 2**20  # bytes
# The largest number of bytes per packed byte; bzip2 packs 45 million equal bytes into 40
LARGEST_PACKING = {"gzip": 1032, "zlib": 1032, "bz2": 2**21}
CUT_SHORT = "the data are cut short or damaged; fetch the file again"


def require_bytes(
    file: VolumeFile, path: Path, offset: int, shape: Shape, dtype: Any, packing: str = ""
) -> None:
    """Raise `BrdfkitError` if the file at `path` is too small for the voxels that a header states.

    `packing` is "gzip", "bz2", "zlib", or empty if the voxels are not packed.
    """
    try:
        present = path.stat().st_size - offset
    except (OSError, ValueError) as error:  # a name in a damaged header may be anything
        raise file.error(f"needs {path.name} beside it; put the two in one folder") from error
    needed = prod(shape) * np.dtype(dtype).itemsize
    if needed > present * LARGEST_PACKING.get(packing, 1):
        size = "×".join(map(str, shape[::-1]))
        raise file.error(
            f"its header tells of {size} voxels, {needed:,} bytes, and the file has {present:,} "
            f"{'packed ones ' if packing else ''}for them: it is cut short, or its header is "
            "wrong; fetch it again"
        )


def read_layers(
    file: VolumeFile, open_stream: Opener, shape: Shape, dtype: DType
) -> Iterator[AnyArray]:
    """Yield the layers (ny, nx) of the stream that the function `open_stream` opens."""
    nz, ny, nx = shape
    size = ny * nx * np.dtype(dtype).itemsize
    try:
        with open_stream() as stream:
            for _ in range(nz):
                data = stream.read(size)
                if len(data) < size:
                    raise file.error(CUT_SHORT)
                yield np.frombuffer(data, dtype).reshape(ny, nx)
            stream.read(1)  # gzip compares its checksum only at the end
    except (EOFError, OSError, zlib.error) as error:
        raise file.error(CUT_SHORT) from error


def make_opener(path: Path, offset: int, packing: str = "", skip: int = 0) -> Opener:
    """Return a function that opens the bytes of a file from `offset` on.

    `packing` is that of `require_bytes`; `skip` is a number of unpacked bytes to leave out.
    """
    openers: dict[str, Any] = {"gzip": gzip.open, "bz2": bz2.open, "zlib": ZlibStream}
    unpack = openers.get(packing, nullcontext)

    @contextmanager
    def open_stream() -> Iterator[Any]:
        with path.open("rb") as raw:
            raw.seek(offset)
            with unpack(raw) as stream:
                if skip:
                    stream.seek(skip)
                yield stream

    return open_stream


def make_text_opener(path: Path, start: int, dtype: DType) -> Opener:
    """Return a function that opens numbers, written as text from `start` on, as bytes."""
    return lambda: nullcontext(parse_numbers(path.read_bytes()[start:], dtype))


def parse_numbers(text: bytes, dtype: DType) -> io.BytesIO:
    """Return a stream of the numbers in a `text`, as bytes; raise EOFError if one is damaged."""
    try:
        with np.errstate(over="ignore", invalid="raise"):
            return io.BytesIO(np.array(text.split(), float).astype(dtype).tobytes())
    except (ValueError, FloatingPointError) as error:  # not a number, or not of this type
        raise EOFError from error


class ZlibStream:
    """A stream of the unpacked bytes of a stream that zlib has packed."""

    def __init__(self, packed: BinaryIO) -> None:
        self.packed = packed
        self.unpacker = zlib.decompressobj()

    def __enter__(self) -> "ZlibStream":
        return self

    def __exit__(self, *error: object) -> None:
        return None

    def read(self, size: int) -> bytes:
        """Read the next `size` bytes, or fewer at the end."""
        parts: list[bytes] = []
        missing = size
        while missing > 0 and not self.unpacker.eof:
            data = self.unpacker.unconsumed_tail or self.packed.read(CHUNK)
            if not data:
                break
            parts.append(self.unpacker.decompress(data, missing))
            missing -= len(parts[-1])
        return b"".join(parts)
