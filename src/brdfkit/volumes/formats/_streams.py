"""Layers of voxels out of streams of bytes: plain, or compressed."""

import bz2
import gzip
import io
import zlib
from contextlib import contextmanager, nullcontext
from math import prod

import numpy as np

CHUNK = 2**20  # bytes
# Bytes that one packed byte may stand for, at most: bzip2 makes 40 of 45 million equal ones
LARGEST_PACKING = {"gzip": 1032, "zlib": 1032, "bz2": 2**21}
CUT_SHORT = "the data are cut short or damaged; fetch the file again"


def require_bytes(file, path, offset, shape, dtype, packing=""):
    """Raise `BrdfkitError` unless a file at `path` can hold the voxels that its header tells of.

    `packing`: how they are packed, "gzip", "bz2" or "zlib", or not at all.
    """
    try:
        present = path.stat().st_size - offset
    except (OSError, ValueError) as error:  # a name out of a damaged header may hold anything
        raise file.error(f"needs {path.name} beside it; put the two in one folder") from error
    needed = prod(shape) * np.dtype(dtype).itemsize
    if needed > present * LARGEST_PACKING.get(packing, 1):
        size = "×".join(map(str, shape[::-1]))
        raise file.error(
            f"its header tells of {size} voxels, {needed:,} bytes, and the file has {present:,} "
            f"{'packed ones ' if packing else ''}for them: it is cut short, or its header is "
            "wrong; fetch it again"
        )


def layers(file, open_stream, shape, dtype):
    """Yields the layers (ny, nx) that the stream holds, which the function `open_stream` opens."""
    nz, ny, nx = shape
    size = ny * nx * np.dtype(dtype).itemsize
    try:
        with open_stream() as stream:
            for _ in range(nz):
                data = stream.read(size)
                if len(data) < size:
                    raise file.error(CUT_SHORT)
                yield np.frombuffer(data, dtype).reshape(ny, nx)
            stream.read(1)  # only at its end does gzip compare its checksum
    except (EOFError, OSError, zlib.error) as error:
        raise file.error(CUT_SHORT) from error


def opener(path, offset, packing="", skip=0):
    """A function that opens the bytes of a file from `offset` on.

    `packing`: how they are packed, "gzip", "bz2", "zlib" or not at all; `skip`: unpacked bytes to
    leave out.
    """
    unpack = {"gzip": gzip.open, "bz2": bz2.open, "zlib": Inflated}.get(packing, nullcontext)

    @contextmanager
    def open_stream():
        with path.open("rb") as raw:
            raw.seek(offset)
            with unpack(raw) as stream:
                if skip:
                    stream.seek(skip)
                yield stream

    return open_stream


def numbers(path, start, dtype):
    """A function that opens the numbers written as text from `start` on, as bytes."""
    return lambda: nullcontext(numbers_in(path.read_bytes()[start:], dtype))


def numbers_in(text, dtype):
    """A stream of the numbers in a `text`, as bytes; what is no number is damage."""
    try:
        with np.errstate(over="ignore", invalid="raise"):
            return io.BytesIO(np.array(text.split(), float).astype(dtype).tobytes())
    except (ValueError, FloatingPointError) as error:  # no number, or none of this type
        raise EOFError from error


class Inflated:
    """A stream of what zlib packed into another stream."""

    def __init__(self, packed):
        self.packed = packed
        self.unpacker = zlib.decompressobj()

    def __enter__(self):
        return self

    def __exit__(self, *error):
        return None

    def read(self, size):
        """The next `size` bytes, fewer at the end."""
        parts, missing = [], size
        while missing > 0 and not self.unpacker.eof:
            data = self.unpacker.unconsumed_tail or self.packed.read(CHUNK)
            if not data:
                break
            parts.append(self.unpacker.decompress(data, missing))
            missing -= len(parts[-1])
        return b"".join(parts)
