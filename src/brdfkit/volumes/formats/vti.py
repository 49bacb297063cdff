"""VTK's image data in XML, files `.vti` with values at points or in cells.

Points lie at origin + direction · (spacing × index), and cells lie between points, so that a grid
of n points has n - 1 cells along an axis. ``model.vti#facies`` names one of several arrays. World
coordinates are those of the file. `_vti_blocks.py` decodes the data.
"""

import mmap
import re
from typing import Any
from xml.etree import ElementTree

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.errors import no_such_error
from brdfkit.volumes.formats._streams import CUT_SHORT, DType, read_layers
from brdfkit.volumes.formats._volume_file import (
    Shape,
    StoredVolume,
    VolumeFile,
    make_grid_transform,
)
from brdfkit.volumes.formats._vti_blocks import Encoding, make_opener

NAME = "VTK image data"
SUFFIXES = (".vti",)

TYPES = {"Int": "i", "UInt": "u", "Float": "f"}
ARRAY = re.compile(rb"<DataArray\b[^>]*?(/?)>")
APPENDED = re.compile(rb"<AppendedData\b[^>]*>\s*_")
END = b"</DataArray>"


def sniff(head: bytes) -> bool:
    """Return whether a file begins like VTK's XML files of image data."""
    return b"<VTKFile" in head and b'type="ImageData"' in head


def read_header(file: VolumeFile) -> StoredVolume:
    """Read the header of a file of VTK's image data."""
    with (
        file.path.open("rb") as stream,
        mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ) as m,
    ):
        root, bodies, appended = _read_xml_without_data(file, m)
        end = len(m)
    image = root.find("ImageData")
    pieces = [] if image is None else image.findall("Piece")
    if image is None or len(pieces) != 1:
        raise file.error(f"has {len(pieces)} pieces; save it as one")
    array, of_cells = _find_data_array(file, pieces[0])
    try:
        shape, to_world = _read_grid(image, pieces[0], of_cells)
        dtype = _read_dtype(array)
        start, stop = bodies[int(array.get("place", ""))]
        place = int(array.get("offset", 0))
    except (AttributeError, OverflowError, TypeError, ValueError) as error:
        raise file.error(f"its header is damaged ({error}); save or fetch it again") from error
    if min(shape) < 1:
        raise file.error(f"has {shape[::-1]} {'cells' if of_cells else 'points'}: no volume")
    if array.get("NumberOfComponents", "1") != "1":
        raise file.error(f"{array.get('Name')} is no scalar; voxels should be single numbers")
    where, form = appended or (None, None)
    if array.get("format") == "appended":
        if where is None:
            raise file.error(CUT_SHORT)
        start, stop = where + place, end
    encoding = Encoding.read(file, root, array.get("format"), form)
    dtype = dtype.newbyteorder(encoding.byte_order)
    open_stream = make_opener(file, start, stop, encoding, shape, dtype)
    return StoredVolume(
        shape, dtype, lambda: read_layers(file, open_stream, shape, dtype), to_world
    )


def _read_grid(
    image: ElementTree.Element, piece: ElementTree.Element, of_cells: bool
) -> tuple[Shape, FloatArray]:
    """Return the shape (nz, ny, nx) of the voxels, and the transform of their indices to the world.

    A voxel is a cell of the grid if `of_cells`, otherwise it is centred at a point.
    """
    sizes: Any = piece.get("Extent", image.get("WholeExtent"))
    extent = np.array(sizes.split(), int).reshape(3, 2)
    spacing, origin = (
        np.array(image.get(key, default).split(), float).reshape(3)
        for key, default in (("Spacing", "1 1 1"), ("Origin", "0 0 0"))
    )
    direction = np.array(image.get("Direction", "1 0 0 0 1 0 0 0 1").split(), float)
    to_world = make_grid_transform(direction.reshape(3, 3), spacing, origin)
    first = extent[:, 0] + (0.5 if of_cells else 0)  # a cell's centre lies between two points
    to_world[:3, 3] = (to_world @ [*first, 1])[:3]
    points = extent[:, 1] - extent[:, 0] + 1
    nx, ny, nz = (points - 1 if of_cells else points).tolist()
    return (nz, ny, nx), to_world


def _read_dtype(array: ElementTree.Element) -> DType:
    """Read the type of an array's numbers from its XML; raise AttributeError if it is damaged."""
    match: Any = re.fullmatch(r"(Int|UInt|Float)(8|16|32|64)", array.get("type", ""))
    kind, bits = match.groups()
    return np.dtype(f"{TYPES[kind]}{int(bits) // 8}")


def _read_xml_without_data(
    file: VolumeFile, data: mmap.mmap
) -> tuple[ElementTree.Element, list[tuple[int, int]], tuple[int, str] | None]:
    """Parse the XML without its data, which may be gigabytes, or raw bytes that are not XML.

    Returns the root element; a list of the bytes (start, end) of each array's data in the file; and
    the first byte and the form, "raw" or "base64", of data appended to the XML, or None if there
    are none. An array's new attribute "place" is its index in the list.
    """
    appended = APPENDED.search(data)
    head_end = appended.start() if appended else len(data)
    parts: list[bytes] = []
    bodies: list[tuple[int, int]] = []
    at = 0
    for tag in ARRAY.finditer(data, 0, head_end):
        close = tag.end() if tag[1] else data.find(END, tag.end())
        close = head_end if close < 0 else close
        place = f' place="{len(bodies)}"'.encode()
        parts += [data[at : tag.start()], b"<DataArray", place, tag[0][len("<DataArray") :]]
        bodies.append((tag.end(), close))
        at = close
    parts.append(data[at:head_end])
    if appended:
        parts.append(b"</VTKFile>")
    try:
        root = ElementTree.fromstring(b"".join(parts))
    except ElementTree.ParseError as error:
        raise file.error(
            f"its XML is cut short or damaged ({error}); save or fetch it again"
        ) from error
    raw = appended and b"base64" not in appended[0]
    form = "raw" if raw else "base64"
    return root, bodies, (appended.end(), form) if appended else None


def _find_data_array(
    file: VolumeFile, piece: ElementTree.Element
) -> tuple[ElementTree.Element, bool]:
    """Return the XML element of the array to read, and whether its values belong to cells.

    It is the array named behind '#' in the user's path, otherwise the file's active scalars.
    """
    arrays: dict[str, tuple[ElementTree.Element, bool, bool]] = {}
    for kind in ("PointData", "CellData"):
        data = piece.find(kind)
        if data is None:
            continue
        for i, array in enumerate(data.findall("DataArray")):
            name = array.get("Name", f"{kind} {i}")
            arrays[name] = array, kind == "CellData", name == data.get("Scalars")
    if not arrays:
        raise file.error("has neither point nor cell data; it should have one array")
    if file.part is not None and file.part not in arrays:
        raise no_such_error("array", file.part, arrays, str(file.path))
    active = [name for name, (*_, is_active) in arrays.items() if is_active] or list(arrays)
    if file.part is None and len(active) > 1:
        raise file.error(
            f"has the arrays {', '.join(arrays)}; name one: {file.path.name}#{active[0]}"
        )
    array, of_cells, _ = arrays[file.part or active[0]]
    return array, of_cells
