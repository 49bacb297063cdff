"""The format NRRD: a file `.nrrd`, or a header `.nhdr` beside a file with the voxels.

The axis x of the voxels is the fastest. The header's ``space directions`` are the vectors from a
voxel to its neighbours. The patient's coordinates are converted to x right, y front, z up. Files
with a field ``Segment0_ID``, Slicer's segmentations, contain labels.
"""

import os
from pathlib import Path
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.volumes.formats._streams import (
    DType,
    Opener,
    make_opener,
    make_text_opener,
    read_layers,
    require_enough_bytes,
)
from brdfkit.volumes.formats._volume_file import (
    Shape,
    StoredVolume,
    VolumeFile,
    make_grid_transform,
)

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
SPACES = {  # factors of x, y and z that convert a space to right, anterior, superior
    "right-anterior-superior": (1, 1, 1),
    "ras": (1, 1, 1),
    "left-posterior-superior": (-1, -1, 1),
    "lps": (-1, -1, 1),
    "left-anterior-superior": (-1, 1, 1),
    "las": (-1, 1, 1),
}
PACKINGS = {"raw": "", "gzip": "gzip", "gz": "gzip", "bzip2": "bz2", "bz2": "bz2"}
TEXT = "ascii", "text", "txt"


def sniff(head: bytes) -> bool:
    """Return whether a file begins with NRRD's magic letters."""
    return head.startswith(b"NRRD0")


def read_header(file: VolumeFile) -> StoredVolume:
    """Read the header of an NRRD file."""
    header, start = _read_fields(file)
    sizes = [int(n) for n in header["sizes"]]
    if len(sizes) != 3 or min(sizes) < 1:
        raise file.error(f"has the size {tuple(sizes)}; it should be three numbers above 0")
    shape = sizes[2], sizes[1], sizes[0]
    dtype = _find_dtype(file, header)
    path = _find_voxel_file(file, header)
    stream = _make_voxel_opener(file, header, path, start if path == file.path else 0, shape, dtype)
    to_world, axes = _make_grid_to_world(file, header)
    unit = (header.get("space units") or [""])[0]
    return StoredVolume(
        shape=shape,
        dtype=dtype,
        layers=lambda: read_layers(file, stream, shape, dtype),
        to_world=to_world,
        labels="Segment0_ID" in header,
        unit=unit or "mm" * bool(axes),
        axes=axes,
    )


def _read_fields(file: VolumeFile) -> tuple[dict[str, Any], int]:
    """Return the header's fields as {name: value}, and the byte at which the voxels begin."""
    nrrd = file.import_package("nrrd", "pynrrd")
    try:
        with file.path.open("rb") as stream:
            header = nrrd.read_header(stream)
            start = stream.tell()
        missing = {"dimension", "type", "encoding", "sizes"} - set(header)
        if missing:
            raise ValueError(f"it lacks {', '.join(sorted(missing))}")
    except Exception as error:
        raise file.error(f"its NRRD header is damaged ({error}); save or fetch it again") from error
    return header, start


def _find_dtype(file: VolumeFile, header: dict[str, Any]) -> DType:
    """Return the type of the voxels that the header states."""
    for code, names in TYPES.items():
        if header["type"].lower() in names.split(", "):
            return np.dtype((">" if header.get("endian") == "big" else "<") + code)
    raise file.error(f"its type {header['type']!r} is not read; voxels should be single numbers")


def _find_voxel_file(file: VolumeFile, header: dict[str, Any]) -> Path:
    """Return the path of the file with the voxels, which is the header's own if it names none."""
    name = header.get("data file", header.get("datafile"))
    if name is None:
        return file.path
    if name.startswith("LIST") or "%" in name:
        raise file.error("its data lie in many files; save it as one .nrrd")
    return file.find_voxel_file(str(name))


def _make_voxel_opener(
    file: VolumeFile, header: dict[str, Any], path: Path, start: int, shape: Shape, dtype: DType
) -> Opener:
    """Return a function that opens the voxels as a stream of bytes, in the header's encoding.

    The voxels, of this `shape` and `dtype`, begin at the byte `start` of `path`, or further on if
    the header says so. Raises `BrdfkitError` if the file is too small for them.
    """
    encoding = header["encoding"].lower()
    skip = int(header.get("byte skip", header.get("byteskip", 0)))
    if int(header.get("line skip", header.get("lineskip", 0))):
        raise file.error("its header has a line skip, which is not read; remove these lines")
    if encoding in TEXT:
        # As text a voxel has at least one digit, and thus as many bytes as np.uint8
        require_enough_bytes(file, path, start, shape, np.uint8)
        return make_text_opener(path, start, dtype)
    if encoding not in PACKINGS:
        raise file.error(f"its encoding {encoding!r} is not read; save it as raw or gzip")
    packing = PACKINGS[encoding]
    if (
        skip == -1 and not packing and os.path.exists(path)
    ):  # -1: the voxels are the file's last bytes
        start, skip = path.stat().st_size - int(np.prod(shape)) * dtype.itemsize, 0
    if skip < 0 or start < 0:
        raise file.error(
            "its byte skip is not possible: the file is cut short; save or fetch it again"
        )
    require_enough_bytes(file, path, start + (0 if packing else skip), shape, dtype, packing)
    if packing:
        return make_opener(path, start, packing, skip)
    return make_opener(path, start + skip)


def _make_grid_to_world(file: VolumeFile, header: dict[str, Any]) -> tuple[FloatArray, str]:
    """Return the transform (4, 4) from the indices of voxels to the world, and the world's axes.

    The axes are "RAS" if the header names a patient's coordinates, otherwise "".
    """
    directions = header.get("space directions")
    spacing = header.get("spacings", np.ones(3))
    flips = SPACES.get(header.get("space", "").lower())
    columns = np.eye(3) * spacing if directions is None else np.asarray(directions, float).T
    origin = header.get("space origin", np.zeros(3))
    if columns.shape != (3, 3) or np.shape(origin) != (3,):
        raise file.error("its space does not have three dimensions; save it again with three")
    to_world = make_grid_transform(columns, np.ones(3), origin)
    if flips is None:
        return to_world, ""
    return np.diag([*flips, 1]) @ to_world, "RAS"
