"""ITK's format MetaImage: a file `.mha`, or a header `.mhd` beside a file with the voxels.

The rows of ``TransformMatrix`` are the directions of the axes, and x is the fastest axis of the
voxels. ITK's world, x to the patient's left and y to the back, is converted to right and front.
"""

import os
from pathlib import Path

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.volumes.formats._streams import (
    make_opener,
    make_text_opener,
    read_layers,
    require_enough_bytes,
)
from brdfkit.volumes.formats._volume_file import (
    LPS_TO_RAS,
    StoredVolume,
    VolumeFile,
    make_grid_transform,
)

NAME = "MetaImage"
SUFFIXES = (".mha", ".mhd")

TYPES = {
    "MET_CHAR": "i1",
    "MET_UCHAR": "u1",
    "MET_SHORT": "i2",
    "MET_USHORT": "u2",
    "MET_INT": "i4",
    "MET_UINT": "u4",
    "MET_LONG": "i4",  # MetaIO's long has 4 bytes on every machine
    "MET_ULONG": "u4",
    "MET_LONG_LONG": "i8",
    "MET_ULONG_LONG": "u8",
    "MET_FLOAT": "f4",
    "MET_DOUBLE": "f8",
}
HEADER_LIMIT = 2**16  # bytes within which the header's last field, ElementDataFile, must come


def sniff(head: bytes) -> bool:
    """Return whether a file begins with a field of MetaImage's header."""
    return head.lstrip().startswith((b"ObjectType", b"NDims")) and b"=" in head[:80]


def read_header(file: VolumeFile) -> StoredVolume:
    """Read the header of a MetaImage file."""
    fields, start = _read_fields(file)
    try:
        sizes = [int(n) for n in fields["DimSize"].split()]
        to_world = _make_grid_to_world(fields)
        code = TYPES.get(fields["ElementType"])
        channels = int(fields.get("ElementNumberOfChannels", 1))
        skip = int(fields.get("HeaderSize", 0))
    except (KeyError, ValueError) as error:
        raise file.error(f"its header is damaged ({error}); save or fetch it again") from error
    if len(sizes) != 3 or min(sizes) < 1:
        raise file.error(f"has the size {tuple(sizes)}; it should be three numbers above 0")
    shape = sizes[2], sizes[1], sizes[0]
    if code is None or channels != 1:
        what = f"{channels} channels of {fields['ElementType']}"
        raise file.error(f"has {what} at each voxel; it should be one number")
    big_endian = _read_boolean_field(fields, "BinaryDataByteOrderMSB", "ElementByteOrderMSB")
    dtype = np.dtype((">" if big_endian else "<") + code)
    path, start = _find_voxel_file(file, fields["ElementDataFile"], start)
    if not _read_boolean_field(fields, "BinaryData", default="True"):
        require_enough_bytes(file, path, start, shape, np.uint8)
        stream = make_text_opener(path, start, dtype)
    else:
        packed = _read_boolean_field(fields, "CompressedData")
        if (
            skip == -1 and not packed and os.path.exists(path)
        ):  # -1: the voxels are the file's last bytes
            start, skip = path.stat().st_size - int(np.prod(shape)) * dtype.itemsize, 0
        start = max(start + max(skip, 0), 0)
        require_enough_bytes(file, path, start, shape, dtype, "zlib" if packed else "")
        stream = make_opener(path, start, "zlib" if packed else "")
    return StoredVolume(
        shape=shape,
        dtype=dtype,
        layers=lambda: read_layers(file, stream, shape, dtype),
        to_world=LPS_TO_RAS @ to_world,
        unit="mm",
        axes="RAS",
    )


def _read_fields(file: VolumeFile) -> tuple[dict[str, str], int]:
    """Return the header's fields as {name: value}, and the header's length [bytes]."""
    fields: dict[str, str] = {}
    read = 0
    with file.path.open("rb") as stream:
        for line in iter(lambda: stream.readline(HEADER_LIMIT), b""):
            read += len(line)
            name, equals, value = line.decode("latin-1").partition("=")
            if not equals or read > HEADER_LIMIT:
                break
            fields[name.strip()] = value.strip()
            if name.strip() == "ElementDataFile":
                return fields, read
    raise file.error("its header has no ElementDataFile at its end; save or fetch it again")


def _make_grid_to_world(fields: dict[str, str]) -> FloatArray:
    """Return the transform (4, 4) from the indices of voxels to ITK's world."""
    matrix = _get_first_field(
        fields, "TransformMatrix", "Rotation", "Orientation", default="1 0 0 0 1 0 0 0 1"
    )
    spacing = _get_first_field(fields, "ElementSpacing", "ElementSize", default="1 1 1")
    origin = _get_first_field(fields, "Offset", "Position", "Origin", default="0 0 0")
    rows, steps, place = (np.array(text.split(), float) for text in (matrix, spacing, origin))
    return make_grid_transform(rows.reshape(3, 3).T, steps.reshape(3), place.reshape(3))


def _find_voxel_file(file: VolumeFile, name: str, start: int) -> tuple[Path, int]:
    """Return the path of the file with the voxels, and the byte in it at which they begin.

    `name` is the header's ElementDataFile. For "LOCAL" the voxels follow the header, at `start`.
    """
    if name.upper() == "LOCAL":
        return file.path, start
    if name.upper().startswith("LIST") or "%" in name:
        raise file.error("its data lie in many files; save it as one .mha")
    return file.find_voxel_file(name), 0


def _read_boolean_field(fields: dict[str, str], *names: str, default: str = "False") -> bool:
    """Return a field of a header as True or False; `default` is its text where it is missing.

    `names` are the names that versions of the format give the field.
    """
    return _get_first_field(fields, *names, default=default).lower() in ("true", "1", "yes")


def _get_first_field(fields: dict[str, str], *names: str, default: str) -> str:
    """Return the value of the first of the `names` that a header has, or the `default`."""
    return next((fields[name] for name in names if name in fields), default)
