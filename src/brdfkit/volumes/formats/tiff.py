"""Stacks of TIFF: a file of many pages, or a folder of files, sorted by the numbers in their names.

Spacing and unit are read where ImageJ or OME wrote them; else a voxel is 1×1×1. The world has the
axes of the pixels: x right, y down, z through the pages.
"""

import logging
import re
from contextlib import contextmanager

import numpy as np

from brdfkit.volumes.formats import _stored
from brdfkit.volumes.formats._stored import Stored, transform
from brdfkit.volumes.formats._streams import layers, opener, require_bytes

NAME = "TIFF"
SUFFIXES = (".tif", ".tiff")

MICRONS = "µm", "um", "micron", "microns", "\\u00B5m"


def sniff(head):
    """Whether the file begins as TIFF or BigTIFF does, in either byte order."""
    return head[:4] in (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+")


def find(file):
    """The volume of a stack, of a file or of a folder."""
    tifffile = file.package("tifffile", "tifffile")
    return _folder(file, tifffile) if file.path.is_dir() else _file(file, tifffile)


def _file(file, tifffile):
    with _opened(file, tifffile, file.path) as tiff:
        series, order = tiff.series[0], tiff.byteorder
        shape, dtype, start = series.shape, series.dtype, series.dataoffset
        axes, count = series.axes, len(tiff.series)
        spacing, unit = _spacing(tiff)
    shape = (1, *shape) if len(shape) == 2 else shape
    if len(shape) != 3 or axes[-1] == "S" or "C" in axes or dtype.kind not in "iuf" or count > 1:
        raise file.error(
            f"has {count} series of {shape} {dtype} over the axes {axes}: colours, channels or "
            "times; save one number for each voxel"
        )
    dtype = dtype.newbyteorder(order)
    if start is None:
        stack = _pages(file, tifffile, [file.path], shape[1:])
    else:  # in one piece: of such a file ImageJ may state the first page alone
        require_bytes(file, file.path, start, shape, dtype)
        stack = layers(file, opener(file.path, start), shape, dtype)
    return Stored(
        shape, dtype, lambda: stack, transform(np.eye(3), spacing, np.zeros(3)), unit=unit
    )


def _folder(file, tifffile):
    paths = sorted(_stored.pictures(file.path), key=_by_numbers)
    kinds = []
    for path in paths:
        with _opened(file, tifffile, path) as tiff:
            kinds.append((tiff.pages[0].shape, tiff.pages[0].dtype, len(tiff.pages)))
    shape, dtype, pages = kinds[0]
    other = next((p for p, kind in zip(paths, kinds, strict=True) if kind != kinds[0]), None)
    if other:
        raise file.error(f"{other.name} is not as large as {paths[0].name}, or of another type")
    if len(shape) != 2 or dtype.kind not in "iuf" or pages != 1:
        raise file.error(
            f"{paths[0].name} has colours or many pages; a layer of numbers belongs there"
        )
    stack = _pages(file, tifffile, paths, shape)
    return Stored((len(paths), *shape), dtype, lambda: stack, np.eye(4))


def _pages(file, tifffile, paths, shape):
    """Yields the pages of the files at `paths`, each of this `shape` (ny, nx)."""
    for path in paths:
        with _opened(file, tifffile, path) as tiff:
            for page in tiff.pages:
                if page.shape != shape:  # asked before its pixels are made room for
                    raise ValueError("its pages differ in size")
                yield page.asarray()


@contextmanager
def _opened(file, tifffile, path):
    """A file opened by tifffile; what fails within the block is an error for people.

    So is what tifffile only logs: a chain of pages that is cut short would else be a smaller stack.
    """
    log, told = logging.getLogger("tifffile"), _Told(logging.ERROR)
    propagate, log.propagate = log.propagate, False
    log.addHandler(told)
    try:
        with tifffile.TiffFile(path) as tiff:
            yield tiff
        if told.texts:
            raise ValueError(told.texts[0])
    except Exception as error:  # of each of its decoders another
        problem = str(error).splitlines()[0][:120] if str(error) else type(error).__name__
        raise file.error(f"{path.name} cannot be read as TIFF ({problem})") from error
    finally:
        log.removeHandler(told)
        log.propagate = propagate


class _Told(logging.Handler):
    """Keeps the texts that are logged."""

    def __init__(self, level):
        super().__init__(level)
        self.texts = []

    def emit(self, record):
        self.texts.append(record.getMessage())


def _spacing(tiff):
    """From voxel to voxel along x, y, z, and its unit."""
    if tiff.ome_metadata:
        pixels = re.search(r"<Pixels\b[^>]*>", tiff.ome_metadata)[0]
        told = dict(re.findall(r'(PhysicalSize\w+)="([^"]*)"', pixels))
        spacing = [float(told.get(f"PhysicalSize{axis}", 1)) for axis in "XYZ"]
        return spacing, told.get("PhysicalSizeXUnit", "µm") if told else ""  # OME's default
    told = tiff.imagej_metadata or {}
    if "spacing" not in told and "unit" not in told:
        return (1, 1, 1), ""
    tags = tiff.pages[0].tags
    pixels = [tags[name].value for name in ("XResolution", "YResolution")]  # pixels per unit
    x, y = (below / max(above, 1e-12) for above, below in pixels)
    unit = str(told.get("unit", ""))
    return (x, y, float(told.get("spacing", 1))), "µm" if unit in MICRONS else unit


def _by_numbers(path):
    """A key by which slice_9 comes before slice_10."""
    return [int(part) if part.isdecimal() else part for part in re.split(r"(\d+)", path.name)]
