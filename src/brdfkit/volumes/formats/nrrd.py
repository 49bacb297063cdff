"""NRRD: `.nrrd`, or a header `.nhdr` beside its data.

Voxels lie x fastest. ``space directions`` are the axes with their spacing; the spaces
left-posterior-superior and left-anterior-superior are turned to RAS. A segmentation of Slicer's
(``Segment0_ID``) has labels.
"""

import numpy as np

from brdfkit.volumes.formats._stored import Stored, transform
from brdfkit.volumes.formats._streams import layers, numbers, opener, require_bytes

NAME = "NRRD"
SUFFIXES = (".nrrd", ".nhdr")

TYPES = {
    "i1": "signed char, int8, int8_t",
    "u1": "uchar, unsigned char, uint8, uint8_t",
    "i2": "short, short int, signed short, signed short int, int16, int16_t",
    "u2": "ushort, unsigned short, unsigned short int, uint16, uint16_t",
    "i4": "int, signed int, int32, int32_t",
    "u4": "uint, unsigned int, uint32, uint32_t",
    "i8": "longlong, long long, long long int, signed long long, int64, int64_t",
    "u8": "ulonglong, unsigned long long, unsigned long long int, uint64, uint64_t",
    "f4": "float",
    "f8": "double",
}
SPACES = {  # which way x, y and z go to become right, anterior, superior
    "right-anterior-superior": (1, 1, 1),
    "ras": (1, 1, 1),
    "left-posterior-superior": (-1, -1, 1),
    "lps": (-1, -1, 1),
    "left-anterior-superior": (-1, 1, 1),
    "las": (-1, 1, 1),
}
PACKINGS = {"raw": "", "gzip": "gzip", "gz": "gzip", "bzip2": "bz2", "bz2": "bz2"}
TEXT = "ascii", "text", "txt"


def sniff(head):
    """Whether the file begins as all NRRD files do."""
    return head.startswith(b"NRRD0")


def find(file):
    """The volume of an NRRD file."""
    header, start = _header(file)
    shape = tuple(int(n) for n in header["sizes"][::-1])
    if len(shape) != 3 or min(shape) < 1:
        raise file.error(f"has axes of {shape[::-1]}; three of 1 or more belong there")
    dtype = _dtype(file, header)
    path = _data_file(file, header)
    stream = _stream(file, header, path, start if path == file.path else 0, shape, dtype)
    to_world, axes = _to_world(file, header)
    unit = (header.get("space units") or [""])[0]
    return Stored(
        shape=shape,
        dtype=dtype,
        layers=lambda: layers(file, stream, shape, dtype),
        to_world=to_world,
        labels="Segment0_ID" in header,
        unit=unit or "mm" * bool(axes),
        axes=axes,
    )


def _header(file):
    """The fields of the header, and where the data begin behind it."""
    nrrd = file.package("nrrd", "pynrrd")
    try:
        with file.path.open("rb") as stream:
            header = nrrd.read_header(stream)
            start = stream.tell()
        missing = {"dimension", "type", "encoding", "sizes"} - set(header)
        if missing:
            raise ValueError(f"it lacks {', '.join(sorted(missing))}")
    except Exception as error:
        raise file.error(f"its NRRD header is damaged ({error}); fetch it again") from error
    return header, start


def _dtype(file, header):
    for code, names in TYPES.items():
        if header["type"].lower() in names.split(", "):
            return np.dtype((">" if header.get("endian") == "big" else "<") + code)
    raise file.error(f"its type {header['type']!r} is not read; one number belongs at each voxel")


def _data_file(file, header):
    """The path of the file with the voxels."""
    name = header.get("data file", header.get("datafile"))
    if name is None:
        return file.path
    if name.startswith("LIST") or "%" in name:
        raise file.error("its data lie in many files; save it as one .nrrd")
    return file.path.parent / name


def _stream(file, header, path, start, shape, dtype):
    """A function that opens the stream of the voxels."""
    encoding = header["encoding"].lower()
    skip = int(header.get("byte skip", header.get("byteskip", 0)))
    if int(header.get("line skip", header.get("lineskip", 0))):
        raise file.error("lines are to be skipped before its data, which is not read; remove them")
    if encoding in TEXT:
        require_bytes(file, path, start, shape, np.uint8)  # a digit and a blank at least
        return numbers(path, start, dtype)
    if encoding not in PACKINGS:
        raise file.error(f"its encoding {encoding!r} is not read; save it as raw or gzip")
    packing = PACKINGS[encoding]
    if skip == -1 and not packing and path.exists():  # the data are the end of the file
        start, skip = path.stat().st_size - int(np.prod(shape)) * dtype.itemsize, 0
    if skip < 0 or start < 0:
        raise file.error("its byte skip is not possible: the file is cut short; fetch it again")
    require_bytes(file, path, start + (0 if packing else skip), shape, dtype, packing)
    return opener(path, start, packing, skip) if packing else opener(path, start + skip)


def _to_world(file, header):
    """The transform to the world, turned to RAS where the header tells how; "RAS", or nothing."""
    directions = header.get("space directions")
    spacing = header.get("spacings", np.ones(3))
    flips = SPACES.get(header.get("space", "").lower())
    columns = np.eye(3) * spacing if directions is None else np.asarray(directions, float).T
    origin = header.get("space origin", np.zeros(3))
    if columns.shape != (3, 3) or np.shape(origin) != (3,):
        raise file.error("its space has not three dimensions; save it anew")
    to_world = transform(columns, np.ones(3), origin)
    if flips is None:
        return to_world, ""
    return np.diag([*flips, 1]) @ to_world, "RAS"
