"""Raw voxels without a header: `.raw`, x fastest.

Their size and type are given, or stand in the name as in ``engine_256x256x128_uint8.raw``, the
convention of the Open SciVis Datasets; or a header, `.mhd` or `.nhdr`, is opened in their place.
"""

import re

import numpy as np

from brdfkit.volumes.formats._stored import Stored
from brdfkit.volumes.formats._streams import layers, opener, require_bytes

NAME = "raw voxels"
SUFFIXES = (".raw",)

IN_NAME = re.compile(r"(\d+)x(\d+)x(\d+)_(u?int(?:8|16|32)|float(?:32|64))")
HEADERS = ".mhd", ".nhdr"


def sniff(head):
    """Always False: there is no header."""
    return False


def find(file):
    """The volume of raw voxels."""
    in_name = IN_NAME.search(file.path.name)
    size, dtype = file.size, file.dtype
    if in_name and size is None and dtype is None:
        size, dtype = tuple(map(int, in_name.groups()[:3])), in_name[4]
    if size is None or dtype is None:
        beside = [file.path.with_suffix(suffix) for suffix in HEADERS]
        header = next((path for path in beside if path.exists()), None)
        raise file.error(
            f"has no header; open {header.name}, which is one"
            if header
            else "has no header; give its size=(nx, ny, nz) and dtype, such as 'uint16' or '>i2'"
        )
    shape, dtype, offset = size[::-1], _dtype(file, dtype), file.offset or 0
    require_bytes(file, file.path, offset, shape, dtype)
    expected = offset + int(np.prod(shape)) * dtype.itemsize
    present = file.path.stat().st_size
    if present != expected:
        raise file.error(
            f"has {present:,} bytes, where {'×'.join(map(str, size))} voxels of {dtype} behind "
            f"{offset} bytes make {expected:,}; give another size, dtype or offset"
        )
    stream = opener(file.path, offset)
    return Stored(shape, dtype, lambda: layers(file, stream, shape, dtype), np.eye(4))


def _dtype(file, given):
    try:
        dtype = np.dtype(given)
    except TypeError:
        dtype = np.dtype(object)
    if dtype.kind not in "iuf":
        raise file.error(f"dtype = {given!r} should be one of numbers, such as 'uint16' or '>i2'")
    return dtype
