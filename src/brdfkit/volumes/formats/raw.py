"""Raw voxels in a file `.raw` without a header, x fastest.

Their size and type are arguments of `volumes.load`, or part of the file's name, as in
``engine_256x256x128_uint8.raw``, the convention of the Open SciVis Datasets. If a header `.mhd` or
`.nhdr` lies beside the file, users should load the header.
"""

import re
from typing import Any

import numpy as np

from brdfkit.volumes.formats._streams import DType, make_opener, read_layers, require_enough_bytes
from brdfkit.volumes.formats._volume_file import StoredVolume, VolumeFile

NAME = "raw voxels"
SUFFIXES = (".raw",)

IN_NAME = re.compile(r"(\d+)x(\d+)x(\d+)_(u?int(?:8|16|32)|float(?:32|64))")
HEADERS = ".mhd", ".nhdr"


def sniff(head: bytes) -> bool:
    """Return False, because raw voxels have no header by which to recognise them."""
    return False


def read_header(file: VolumeFile) -> StoredVolume:
    """Return the volume with the size and type that the user or the file's name gives.

    Raises `BrdfkitError` if neither does, or unless the file is exactly as large as these voxels.
    """
    in_name = IN_NAME.search(file.path.name)
    size, dtype = file.size, file.dtype
    if in_name and size is None and dtype is None:
        size, dtype = (int(in_name[1]), int(in_name[2]), int(in_name[3])), in_name[4]
    if size is None or dtype is None:
        beside = [file.path.with_suffix(suffix) for suffix in HEADERS]
        header = next((path for path in beside if path.exists()), None)
        raise file.error(
            f"has no header; open its header, {header.name}"
            if header
            else "has no header; name it by its voxels along x, y and z and their type, as "
            f"{file.path.stem}_256x256x128_uint8{file.path.suffix}, or give size=(nx, ny, nz) and "
            "dtype in Python"
        )
    shape, dtype, offset = (size[2], size[1], size[0]), _parse_dtype(file, dtype), file.offset or 0
    require_enough_bytes(file, file.path, offset, shape, dtype)
    expected = offset + int(np.prod(shape)) * dtype.itemsize
    present = file.path.stat().st_size
    if present != expected:
        raise file.error(
            f"has {present:,} bytes, where {'×'.join(map(str, size))} voxels of {dtype} behind "
            f"{offset} bytes make {expected:,}; give another size, dtype or offset"
        )
    stream = make_opener(file.path, offset)
    return StoredVolume(shape, dtype, lambda: read_layers(file, stream, shape, dtype), np.eye(4))


def _parse_dtype(file: VolumeFile, given: Any) -> DType:
    """Convert the user's dtype, `given`, to NumPy's; raise `BrdfkitError` if it has no numbers."""
    try:
        dtype: DType = np.dtype(given)
    except TypeError:
        dtype = np.dtype(object)
    if dtype.kind not in "iuf":
        raise file.error(f"dtype = {given!r} is no type of numbers, such as 'uint16' or '>i2'")
    return dtype
