"""Arrays kept small without loss: shadows are mostly 0 or 1, and maps wide areas of one number."""

import zlib
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Packed:
    """An array by its `shape`, its `kind` (NumPy's dtype) and its compressed bytes, `data`."""

    shape: tuple[int, ...]
    kind: str
    data: bytes

    @classmethod
    def of(cls, array):
        """Of any array; neighbours' bytes of one place stand together, which packs better."""
        bytes_apart = np.ascontiguousarray(array).reshape(-1, 1).view(np.uint8).T
        return cls(array.shape, array.dtype.str, zlib.compress(bytes_apart.tobytes()))

    @property
    def array(self):
        kind = np.dtype(self.kind)
        found = np.frombuffer(zlib.decompress(self.data), np.uint8).reshape(kind.itemsize, -1)
        return np.ascontiguousarray(found.T).view(kind).reshape(self.shape)
