"""The file formats of volumes: every file of this folder without an underscore is one.

A format's file defines

- ``NAME``, the name for display, and ``SUFFIXES``, such as ``(".nrrd", ".nhdr")``;
- ``sniff(head)``: whether the first 4 kB of a file, unpacked if gzip, look like this format;
- ``read_header(file)``: reads the header of a `VolumeFile`, and returns a `StoredVolume`, which
  reads the voxels layer by layer.

`_volume_file.py` and `_streams.py` are shared by several formats. The packages nibabel, pynrrd,
pydicom and tifffile, each for one format, are imported when a file needs them.
"""

import gzip
import zlib
from functools import cache
from pathlib import Path
from types import ModuleType

from brdfkit.core.discovery.plugin_files import import_modules
from brdfkit.core.errors import BrdfkitError
from brdfkit.volumes.formats import _volume_file
from brdfkit.volumes.formats._volume_file import StoredVolume as StoredVolume
from brdfkit.volumes.formats._volume_file import VolumeFile as VolumeFile

HEAD = 4096  # bytes that a format's `sniff` gets


@cache
def list_formats() -> tuple[ModuleType, ...]:
    """Return the format modules of this folder, in alphabetical order."""
    return import_modules(__name__, __path__)


def has_format(name: str | Path) -> bool:
    """Return whether a file's name has the suffix of a format."""
    return any(str(name).lower().endswith(module.SUFFIXES) for module in list_formats())


def is_series(folder: Path) -> bool:
    """Return whether a folder contains a TIFF file or a DICOM file."""
    if not folder.is_dir():
        return False
    sniff = _find_format("dicom").sniff
    return bool(_volume_file.list_tiffs(folder)) or any(
        sniff(_volume_file.read_head(path, HEAD)) for path in _volume_file.list_files(folder)
    )


def read_header(file: VolumeFile) -> StoredVolume:
    """Read the header of a file, by the format that recognises its content, or else its suffix."""
    if file.path.is_dir():
        return _read_as(_find_format(_volume_file.folder_format(file)), file)
    if not (file.size is file.dtype is file.offset is None):  # settings of raw voxels alone
        return _read_as(_find_format("raw"), file)
    head, packed = _read_head(file)
    sniffed = [module for module in list_formats() if module.sniff(head)]
    named = [m for m in list_formats() if str(file.path).lower().endswith(m.SUFFIXES)]
    for module in (*sniffed, *named):
        if packed and not has_packed(module):
            raise file.error(f"is {module.NAME} packed by gzip, which is not read; unpack it")
        return _read_as(module, file)
    known = ", ".join(f"{module.NAME} ({' '.join(module.SUFFIXES)})" for module in list_formats())
    raise file.error(f"is in no known format of volumes; read are {known}")


def has_packed(module: ModuleType) -> bool:
    """Return whether files of a format may be packed by gzip as a whole."""
    return any(suffix.endswith(".gz") for suffix in module.SUFFIXES)


def _read_as(module: ModuleType, file: VolumeFile) -> StoredVolume:
    """Read the header of a file by the module of its format."""
    stored: StoredVolume = module.read_header(file)
    return stored


def _find_format(name: str) -> ModuleType:
    """Return the format module of this name."""
    return next(module for module in list_formats() if module.__name__.endswith(f".{name}"))


def _read_head(file: VolumeFile) -> tuple[bytes, bool]:
    """Return the first bytes of a file, unpacked, and whether they were packed by gzip."""
    try:
        with file.path.open("rb") as stream:
            head = stream.read(HEAD)
        if not head:
            raise file.error("the file is empty; fetch it again")
        packed = head.startswith(b"\x1f\x8b")
        if packed:
            with gzip.open(file.path) as stream:
                head = stream.read(HEAD)
    except (EOFError, zlib.error, gzip.BadGzipFile) as error:
        raise file.error(f"the compressed data are damaged ({error}); fetch it again") from error
    except OSError as error:
        raise BrdfkitError(f"{file.path}: cannot be read ({error.strerror}).") from error
    return head, packed
