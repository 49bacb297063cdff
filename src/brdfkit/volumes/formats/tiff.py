"""TIFF stacks: a file of many pages, or a folder of files, sorted by the numbers in their names.

Spacing and unit are read from the metadata of ImageJ or OME; without them a voxel is 1×1×1. The
world's axes are those of the pixels: x right, y down, z through the pages.
"""

import logging
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray
from brdfkit.volumes.formats import _volume_file
from brdfkit.volumes.formats._streams import make_opener, read_layers, require_enough_bytes
from brdfkit.volumes.formats._volume_file import StoredVolume, VolumeFile, make_grid_transform

NAME = "TIFF"
SUFFIXES = (".tif", ".tiff")

MICRONS = "µm", "um", "micron", "microns", "\\u00B5m"


def sniff(head: bytes) -> bool:
    """Return whether a file begins like TIFF or BigTIFF, in either byte order."""
    return head[:4] in (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+")


def read_header(file: VolumeFile) -> StoredVolume:
    """Read the header of a TIFF stack, which is a file of many pages or a folder of files."""
    tifffile = file.import_package("tifffile", "tifffile")
    return _read_folder(file, tifffile) if file.path.is_dir() else _read_file(file, tifffile)


def _read_file(file: VolumeFile, tifffile: Any) -> StoredVolume:
    """Read the header of a TIFF file with many pages, the layers of a volume."""
    with _open_tiff(file, tifffile, file.path) as tiff:
        series, order = tiff.series[0], tiff.byteorder
        shape, dtype, start = series.shape, series.dtype, series.dataoffset
        axes, count = series.axes, len(tiff.series)
        spacing, unit = _read_spacing(tiff)
    shape = (1, *shape) if len(shape) == 2 else shape
    if len(shape) != 3 or axes[-1] == "S" or "C" in axes or dtype.kind not in "iuf" or count > 1:
        raise file.error(
            f"has {count} series of {shape} {dtype} over the axes {axes}: colours, channels or "
            "times; save one number for each voxel"
        )
    dtype = dtype.newbyteorder(order)
    if start is None:
        stack = _read_pages(file, tifffile, [file.path], shape[1:])
    else:  # ImageJ writes large stacks as one piece, of which it lists only the first page
        require_enough_bytes(file, file.path, start, shape, dtype)
        stack = read_layers(file, make_opener(file.path, start), shape, dtype)
    return StoredVolume(
        shape, dtype, lambda: stack, make_grid_transform(np.eye(3), spacing, np.zeros(3)), unit=unit
    )


def _read_folder(file: VolumeFile, tifffile: Any) -> StoredVolume:
    """Read the headers of the TIFF files in a folder, of which each has one layer of a volume."""
    paths = sorted(_volume_file.list_tiffs(file.path), key=_natural_sort_key)
    kinds = []
    for path in paths:
        with _open_tiff(file, tifffile, path) as tiff:
            kinds.append((tiff.pages[0].shape, tiff.pages[0].dtype, len(tiff.pages)))
    shape, dtype, pages = kinds[0]
    other = next((p for p, kind in zip(paths, kinds, strict=True) if kind != kinds[0]), None)
    if other:
        raise file.error(f"{other.name} and {paths[0].name} differ in size or type of pixels")
    if len(shape) != 2 or dtype.kind not in "iuf" or pages != 1:
        raise file.error(
            f"{paths[0].name} has colours or many pages; it should be one layer of numbers"
        )
    stack = _read_pages(file, tifffile, paths, shape)
    return StoredVolume((len(paths), *shape), dtype, lambda: stack, np.eye(4))


def _read_pages(
    file: VolumeFile, tifffile: Any, paths: list[Path], shape: tuple[int, int]
) -> Iterator[AnyArray]:
    """Yield the pixels (ny, nx) of each page of the files at `paths`.

    Raises `BrdfkitError` if a page does not have this `shape`.
    """
    for path in paths:
        with _open_tiff(file, tifffile, path) as tiff:
            for page in tiff.pages:
                if page.shape != shape:  # before memory is taken for pixels of a damaged size
                    raise ValueError("its pages differ in size")
                yield page.asarray()


@contextmanager
def _open_tiff(file: VolumeFile, tifffile: Any, path: Path) -> Iterator[Any]:
    """Open a file by tifffile, and convert errors of the `with` block to a `BrdfkitError`.

    Errors that tifffile only logs are raised as well: otherwise a file that lost its last pages
    would be read as a smaller stack.
    """
    log, logged = logging.getLogger("tifffile"), _LogRecorder(logging.ERROR)
    propagate, log.propagate = log.propagate, False
    log.addHandler(logged)
    try:
        # Metadata of OME may name other files, of which no page is read
        with tifffile.TiffFile(path, _multifile=False) as tiff:
            yield tiff
        if logged.texts:
            raise ValueError(logged.texts[0])
    except Exception as error:  # tifffile and its decoders raise errors of many classes
        problem = str(error).splitlines()[0][:120] if str(error) else type(error).__name__
        raise file.error(f"{path.name} cannot be read as TIFF ({problem})") from error
    finally:
        log.removeHandler(logged)
        log.propagate = propagate


class _LogRecorder(logging.Handler):
    """A logging handler that collects the logged messages in its list `texts`."""

    def __init__(self, level: int) -> None:
        super().__init__(level)
        self.texts: list[str] = []

    def emit(self, record: logging.LogRecord) -> None:
        self.texts.append(record.getMessage())


def _read_spacing(tiff: Any) -> tuple[list[float], str]:
    """Read the voxel spacing along x, y, z and its unit from metadata of OME or ImageJ, if any."""
    if tiff.ome_metadata:
        pixels: Any = re.search(r"<Pixels\b[^>]*>", tiff.ome_metadata)
        sizes = dict(re.findall(r'(PhysicalSize\w+)="([^"]*)"', pixels[0]))
        spacing = [float(sizes.get(f"PhysicalSize{axis}", 1)) for axis in "XYZ"]
        return spacing, sizes.get("PhysicalSizeXUnit", "µm") if sizes else ""  # OME's default is µm
    metadata = tiff.imagej_metadata or {}
    if "spacing" not in metadata and "unit" not in metadata:
        return [1, 1, 1], ""
    tags = tiff.pages[0].tags
    # A resolution is the numerator and the denominator of the number of pixels per unit of length
    resolutions = [tags[name].value for name in ("XResolution", "YResolution")]
    x, y = (below / max(above, 1e-12) for above, below in resolutions)
    unit = str(metadata.get("unit", ""))
    return [x, y, float(metadata.get("spacing", 1))], "µm" if unit in MICRONS else unit


def _natural_sort_key(path: Path) -> list[int | str]:
    """Return a key that sorts file names by their numbers, such as slice_9 before slice_10."""
    return [int(part) if part.isdecimal() else part for part in re.split(r"(\d+)", path.name)]
