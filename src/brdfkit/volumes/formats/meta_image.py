"""MetaImage: `.mha`, or a header `.mhd` beside its data, as ITK writes them.

A row of ``TransformMatrix`` is the direction of an axis, and voxels lie x fastest. The world is
ITK's, LPS, and is turned to RAS.
"""

import numpy as np

from brdfkit.volumes.formats._stored import LPS_TO_RAS, Stored, transform
from brdfkit.volumes.formats._streams import layers, numbers, opener, require_bytes

NAME = "MetaImage"
SUFFIXES = (".mha", ".mhd")

TYPES = {
    "MET_CHAR": "i1",
    "MET_UCHAR": "u1",
    "MET_SHORT": "i2",
    "MET_USHORT": "u2",
    "MET_INT": "i4",
    "MET_UINT": "u4",
    "MET_LONG": "i4",  # of MetaIO, on every machine
    "MET_ULONG": "u4",
    "MET_LONG_LONG": "i8",
    "MET_ULONG_LONG": "u8",
    "MET_FLOAT": "f4",
    "MET_DOUBLE": "f8",
}
LONGEST = 2**16  # bytes of a header


def sniff(head):
    """Whether the file begins with fields of a MetaImage."""
    return head.lstrip().startswith((b"ObjectType", b"NDims")) and b"=" in head[:80]


def find(file):
    """The volume of a MetaImage."""
    fields, start = _fields(file)
    try:
        shape = tuple(int(n) for n in fields["DimSize"].split())[::-1]
        to_world = _to_world(fields)
        dtype = TYPES.get(fields["ElementType"])
        channels = int(fields.get("ElementNumberOfChannels", 1))
        skip = int(fields.get("HeaderSize", 0))
    except (KeyError, ValueError) as error:
        raise file.error(f"its header is damaged ({error}); fetch it again") from error
    if len(shape) != 3 or min(shape) < 1:
        raise file.error(f"has axes of {shape[::-1]}; three of 1 or more belong there")
    if dtype is None or channels != 1:
        what = f"{channels} channels of {fields['ElementType']}"
        raise file.error(f"has {what} at each voxel; one number belongs there")
    most_first = _is_true(fields, "BinaryDataByteOrderMSB", "ElementByteOrderMSB")
    dtype = np.dtype((">" if most_first else "<") + dtype)
    path, start = _data_file(file, fields["ElementDataFile"], start)
    if not _is_true(fields, "BinaryData", default="True"):
        require_bytes(file, path, start, shape, np.uint8)
        stream = numbers(path, start, dtype)
    else:
        packed = _is_true(fields, "CompressedData")
        if skip == -1 and not packed and path.exists():  # the data are the end of the file
            start, skip = path.stat().st_size - int(np.prod(shape)) * dtype.itemsize, 0
        start = max(start + max(skip, 0), 0)
        require_bytes(file, path, start, shape, dtype, "zlib" if packed else "")
        stream = opener(path, start, "zlib" if packed else "")
    return Stored(
        shape=shape,
        dtype=dtype,
        layers=lambda: layers(file, stream, shape, dtype),
        to_world=LPS_TO_RAS @ to_world,
        unit="mm",
        axes="RAS",
    )


def _fields(file):
    """The fields of the header, and where it ends."""
    fields, read = {}, 0
    with file.path.open("rb") as stream:
        for line in iter(lambda: stream.readline(LONGEST), b""):
            read += len(line)
            name, equals, value = line.decode("latin-1").partition("=")
            if not equals or read > LONGEST:
                break
            fields[name.strip()] = value.strip()
            if name.strip() == "ElementDataFile":
                return fields, read
    raise file.error("its header has no ElementDataFile at its end; fetch it again")


def _to_world(fields):
    matrix = _first(
        fields, "TransformMatrix", "Rotation", "Orientation", default="1 0 0 0 1 0 0 0 1"
    )
    spacing = _first(fields, "ElementSpacing", "ElementSize", default="1 1 1")
    origin = _first(fields, "Offset", "Position", "Origin", default="0 0 0")
    rows, spacing, origin = (np.array(text.split(), float) for text in (matrix, spacing, origin))
    return transform(rows.reshape(3, 3).T, spacing.reshape(3), origin.reshape(3))


def _data_file(file, name, start):
    if name.upper() == "LOCAL":
        return file.path, start
    if name.upper().startswith("LIST") or "%" in name:
        raise file.error("its data lie in many files; save it as one .mha")
    return file.path.parent / name, 0


def _is_true(fields, *names, default="False"):
    return _first(fields, *names, default=default).lower() in ("true", "1", "yes")


def _first(fields, *names, default):
    return next((fields[name] for name in names if name in fields), default)
