"""VTK's image data in XML: `.vti`, of point or cell data.

Points lie at origin + direction · (spacing × index), cells between them, so that a grid of n points
has n - 1 cells along an axis. ``model.vti#facies`` names one of several arrays. The world is the
file's own. The blocks of the data are in `_vti_blocks.py`.
"""

import mmap
import re
from xml.etree import ElementTree

import numpy as np

from brdfkit.core.errors import no_such
from brdfkit.volumes.formats._stored import Stored, transform
from brdfkit.volumes.formats._streams import CUT_SHORT, layers
from brdfkit.volumes.formats._vti_blocks import Encoding, opener

NAME = "VTK image data"
SUFFIXES = (".vti",)

TYPES = {"Int": "i", "UInt": "u", "Float": "f"}
ARRAY = re.compile(rb"<DataArray\b[^>]*?(/?)>")
APPENDED = re.compile(rb"<AppendedData\b[^>]*>\s*_")
END = b"</DataArray>"


def sniff(head):
    """Whether the file begins as VTK's XML files of images do."""
    return b"<VTKFile" in head and b'type="ImageData"' in head


def find(file):
    """The volume of a file of VTK's image data."""
    with (
        file.path.open("rb") as stream,
        mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ) as m,
    ):
        root, bodies, appended = _skeleton(file, m)
        end = len(m)
    image = root.find("ImageData")
    pieces = [] if image is None else image.findall("Piece")
    if len(pieces) != 1:
        raise file.error(f"has {len(pieces)} pieces; one belongs there")
    array, of_cells = _array(file, pieces[0])
    try:
        shape, to_world = _grid(image, pieces[0], of_cells)
        dtype = _dtype(array)
        start, stop = bodies[int(array.get("place"))]
        place = int(array.get("offset", 0))
    except (AttributeError, OverflowError, TypeError, ValueError) as error:
        raise file.error(f"its header is damaged ({error}); fetch it again") from error
    if min(shape) < 1:
        raise file.error(f"has {shape[::-1]} {'cells' if of_cells else 'points'}: no volume")
    if array.get("NumberOfComponents", "1") != "1":
        raise file.error(f"{array.get('Name')} is no scalar; one number belongs at each voxel")
    where, form = appended or (None, None)
    if array.get("format") == "appended":
        if where is None:
            raise file.error(CUT_SHORT)
        start, stop = where + place, end
    encoding = Encoding.of(file, root, array.get("format"), form)
    dtype = dtype.newbyteorder(encoding.byte_order)
    stream = opener(file, start, stop, encoding, shape, dtype)
    return Stored(shape, dtype, lambda: layers(file, stream, shape, dtype), to_world)


def _grid(image, piece, of_cells):
    """(nz, ny, nx) of the voxels, and their transform to the world."""
    extent = np.array(piece.get("Extent", image.get("WholeExtent")).split(), int).reshape(3, 2)
    spacing, origin = (
        np.array(image.get(key, default).split(), float).reshape(3)
        for key, default in (("Spacing", "1 1 1"), ("Origin", "0 0 0"))
    )
    direction = np.array(image.get("Direction", "1 0 0 0 1 0 0 0 1").split(), float)
    to_world = transform(direction.reshape(3, 3), spacing, origin)
    first = extent[:, 0] + (0.5 if of_cells else 0)  # a cell's middle lies between points
    to_world[:3, 3] = (to_world @ [*first, 1])[:3]
    points = extent[:, 1] - extent[:, 0] + 1
    return tuple(int(n) for n in (points - 1 if of_cells else points)[::-1]), to_world


def _dtype(array):
    kind, bits = re.fullmatch(r"(Int|UInt|Float)(8|16|32|64)", array.get("type", "")).groups()
    return np.dtype(f"{TYPES[kind]}{int(bits) // 8}")


def _skeleton(file, data):
    """The XML without its data; where the bodies of the arrays lie; where what is appended begins,
    and its encoding.

    What is appended raw is no XML, and the bodies may be gigabytes.
    """
    appended = APPENDED.search(data)
    head_end = appended.start() if appended else len(data)
    parts, bodies, at = [], [], 0
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
        raise file.error(f"its XML is cut short or damaged ({error}); fetch it again") from error
    raw = appended and b"base64" not in appended[0]
    return root, bodies, appended and (appended.end(), "raw" if raw else "base64")


def _array(file, piece):
    """The element of the array to read, and whether it is of cells."""
    found = {}
    for kind in ("PointData", "CellData"):
        data = piece.find(kind)
        for i, array in enumerate([] if data is None else data.findall("DataArray")):
            name = array.get("Name", f"{kind} {i}")
            found[name] = array, kind == "CellData", name == data.get("Scalars")
    if not found:
        raise file.error("has neither point nor cell data; one array belongs there")
    if file.part is not None and file.part not in found:
        raise no_such("array", file.part, found, str(file.path))
    active = [name for name, (*_, is_active) in found.items() if is_active] or list(found)
    if file.part is None and len(active) > 1:
        raise file.error(f"holds {', '.join(found)}; name one: {file.path.name}#{active[0]}")
    array, of_cells, _ = found[file.part or active[0]]
    return array, of_cells
