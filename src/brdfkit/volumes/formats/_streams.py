"""Reading of voxels, layer by layer, from files of plain bytes, packed bytes, or numbers as text.

Formats make an opener, a function that opens the voxels' bytes as a stream, and pass it to
`read_layers`.
"""

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
Opener: TypeAlias = Callable[[], AbstractContextManager[Any]]  # opens a stream of voxels' bytes

CHUNK = 2**20  # packed bytes that are read from a file at a time
# Largest number of bytes per packed byte; bzip2 packs 45 million equal bytes into 40
LARGEST_PACKING = {"gzip": 1032, "zlib": 1032, "bz2": 2**21}
CUT_SHORT = "the data are cut short or damaged; save or fetch the file again"


def require_enough_bytes(
    file: VolumeFile, path: Path, offset: int, shape: Shape, dtype: Any, packing: str = ""
) -> None:
    """Raise `BrdfkitError` if the file at `path` cannot contain voxels of this `shape` and `dtype`.

    It thus finds damaged headers before memory is taken for their voxels, which begin at the byte
    `offset`. `packing` is "gzip", "bz2", "zlib", or empty if the voxels are not packed.
    """
    try:
        present = path.stat().st_size - offset
    except (OSError, ValueError) as error:  # a damaged header may name an impossible path
        raise file.error(f"needs {path.name} beside it; put the two in one folder") from error
    needed = prod(shape) * np.dtype(dtype).itemsize
    if needed > present * LARGEST_PACKING.get(packing, 1):
        size = "×".join(map(str, shape[::-1]))
        raise file.error(
            f"its header states {size} voxels, which are {needed:,} bytes, but the file has only "
            f"{present:,} {'packed ' if packing else ''}bytes for them: it is cut short, or its "
            "header is wrong; save or fetch it again"
        )


def read_layers(
    file: VolumeFile, open_stream: Opener, shape: Shape, dtype: DType
) -> Iterator[AnyArray]:
    """Yield the layers (ny, nx) of voxels from the stream that `open_stream` opens.

    Raises `BrdfkitError`, which names `file`, if the stream ends too early or is damaged.
    """
    nz, ny, nx = shape
    size = ny * nx * np.dtype(dtype).itemsize
    try:
        with open_stream() as stream:
            for _ in range(nz):
                data = stream.read(size)
                if len(data) < size:
                    raise file.error(CUT_SHORT)
                yield np.frombuffer(data, dtype).reshape(ny, nx)
            stream.read(1)  # gzip verifies its checksum only when a read meets the end
    except (EOFError, OSError, zlib.error) as error:
        raise file.error(CUT_SHORT) from error


def make_opener(path: Path, offset: int, packing: str = "", skip: int = 0) -> Opener:
    """Return a function that opens a stream of a file's bytes from `offset` on, unpacked.

    `packing` is "gzip", "bz2", "zlib", or empty for plain bytes. `skip` is the number of unpacked
    bytes before the first voxel.
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
    """Return a function that reads numbers written as text, and opens them as a binary stream.

    The text begins at the byte `start` of the file; `dtype` is the type of the binary numbers.
    """
    return lambda: nullcontext(parse_numbers(path.read_bytes()[start:], dtype))


def parse_numbers(text: bytes, dtype: DType) -> io.BytesIO:
    """Convert the numbers in a `text` to a stream of binary numbers of this `dtype`.

    Raises EOFError, as a cut binary stream does, if a number is damaged or beyond the `dtype`.
    """
    try:
        with np.errstate(over="ignore", invalid="raise"):
            return io.BytesIO(np.array(text.split(), float).astype(dtype).tobytes())
    except (ValueError, FloatingPointError) as error:
        raise EOFError from error


class ZlibStream:
    """A stream that unpacks the bytes of another stream, which zlib has packed.

    It is used like `gzip.open(stream)`; Python's module zlib has no such function.
    """

    def __init__(self, packed: BinaryIO) -> None:
        self.packed = packed
        self.unpacker = zlib.decompressobj()

    def __enter__(self) -> "ZlibStream":
        return self

    def __exit__(self, *error: object) -> None:
        return None

    def read(self, size: int) -> bytes:
        """Read the next `size` unpacked bytes, or fewer at the end."""
        parts: list[bytes] = []
        missing = size
        while missing > 0 and not self.unpacker.eof:
            data = self.unpacker.unconsumed_tail or self.packed.read(CHUNK)
            if not data:
                break
            parts.append(self.unpacker.decompress(data, missing))
            missing -= len(parts[-1])
        return b"".join(parts)
