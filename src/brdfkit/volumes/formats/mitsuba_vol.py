"""Mitsuba's `.vol`: version 3, one channel of float32, x fastest, and the box of its faces."""

import struct

import numpy as np

from brdfkit.volumes.formats._stored import Stored, transform
from brdfkit.volumes.formats._streams import layers, opener, require_bytes

NAME = "Mitsuba's grid"
SUFFIXES = (".vol",)

HEADER = struct.Struct("<3sB5i6f")  # VOL, version, encoding, nx, ny, nz, channels, box


def sniff(head):
    """Whether the file begins as Mitsuba's grids do."""
    return head.startswith(b"VOL")


def find(file):
    """The volume of a grid of Mitsuba's."""
    with file.path.open("rb") as stream:
        head = stream.read(HEADER.size)
    if len(head) < HEADER.size or head[:3] != b"VOL":
        raise file.error("is no grid of Mitsuba's, or cut short; fetch it again")
    _, version, encoding, nx, ny, nz, channels, *box = HEADER.unpack(head)
    if (version, encoding) != (3, 1):
        raise file.error(
            f"has version {version} and encoding {encoding}; 3 and 1, float32, are read"
        )
    if channels != 1:
        raise file.error(f"has {channels} channels; one number belongs at each voxel")
    if min(nx, ny, nz) < 1:
        raise file.error(f"its header tells of {nx}×{ny}×{nz} voxels; it is damaged")
    shape, dtype = (nz, ny, nx), np.dtype("<f4")
    require_bytes(file, file.path, HEADER.size, shape, dtype)
    low, high = np.reshape(box, (2, 3))
    spacing = (high - low) / (nx, ny, nz)
    stream = opener(file.path, HEADER.size)
    return Stored(
        shape=shape,
        dtype=dtype,
        layers=lambda: layers(file, stream, shape, dtype),
        to_world=transform(np.eye(3), spacing, low + spacing / 2),
    )
