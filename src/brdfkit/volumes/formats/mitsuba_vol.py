"""Mitsuba's format `.vol`, version 3: one channel of float32, x fastest, and the volume's box."""

import struct

import numpy as np

from brdfkit.volumes.formats._streams import make_opener, read_layers, require_enough_bytes
from brdfkit.volumes.formats._volume_file import StoredVolume, VolumeFile, make_grid_transform

NAME = "Mitsuba's grid"
SUFFIXES = (".vol",)

HEADER = struct.Struct("<3sB5i6f")  # "VOL", version, type, nx, ny, nz, channels, box


def sniff(head: bytes) -> bool:
    """Return whether a file begins with the letters of Mitsuba's volume grids."""
    return head.startswith(b"VOL")


def read_header(file: VolumeFile) -> StoredVolume:
    """Read the header of one of Mitsuba's volume grids."""
    with file.path.open("rb") as stream:
        head = stream.read(HEADER.size)
    if len(head) < HEADER.size or head[:3] != b"VOL":
        raise file.error(
            "is not a volume grid of Mitsuba's, or is cut short; save or fetch it again"
        )
    _, version, encoding, nx, ny, nz, channels, *box = HEADER.unpack(head)
    if (version, encoding) != (3, 1):
        raise file.error(
            f"has version {version} and encoding {encoding}; only version 3 and encoding 1, "
            "float32, are read"
        )
    if channels != 1:
        raise file.error(f"has {channels} channels; it should have one number at each voxel")
    if min(nx, ny, nz) < 1:
        raise file.error(f"its header states {nx}×{ny}×{nz} voxels; it is damaged")
    shape, dtype = (nz, ny, nx), np.dtype("<f4")
    require_enough_bytes(file, file.path, HEADER.size, shape, dtype)
    low, high = np.reshape(box, (2, 3))
    spacing = (high - low) / (nx, ny, nz)
    open_stream = make_opener(file.path, HEADER.size)
    return StoredVolume(
        shape=shape,
        dtype=dtype,
        layers=lambda: read_layers(file, open_stream, shape, dtype),
        to_world=make_grid_transform(np.eye(3), spacing, low + spacing / 2),
    )
