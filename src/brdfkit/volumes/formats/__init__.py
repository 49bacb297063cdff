"""The file formats of volumes: each module of this folder without an underscore reads one format.

Such a module defines

- ``NAME``, the format's name in messages, and ``SUFFIXES``, such as ``(".nrrd", ".nhdr")``;
- ``sniff(head)``, which returns whether the first 4 kB of a file, unpacked from gzip, look like
  the format;
- ``read_header(file)``, which reads the header of a `VolumeFile`. It returns a `StoredVolume`,
  which then reads the voxels layer by layer.

Several formats share `_volume_file.py` and `_streams.py`. The packages nibabel, pynrrd, pydicom and
tifffile, each for one format, are imported only when a file needs them.
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
from brdfkit.volumes.formats._volume_file import confine_headers as confine_headers

HEAD = 4096  # bytes from the start of a file by which `sniff` recognises a format


class UnknownFormatError(BrdfkitError):
    """The error for a file that is in no format of volumes."""


@cache
def list_formats() -> tuple[ModuleType, ...]:
    """Return the format modules of this folder, in alphabetical order."""
    return import_modules(__name__, __path__)


def describe_formats() -> str:
    """Return the names of the formats with their suffixes."""
    return ", ".join(f"{module.NAME} ({' '.join(module.SUFFIXES)})" for module in list_formats())


def has_volume_suffix(name: str | Path) -> bool:
    """Return whether a file's name ends with the suffix of a volume format."""
    return any(str(name).lower().endswith(module.SUFFIXES) for module in list_formats())


def is_image_series(folder: Path) -> bool:
    """Return whether a path is a folder that contains a TIFF file or a DICOM file."""
    if not folder.is_dir():
        return False
    sniff = _find_format_module("dicom").sniff
    return bool(_volume_file.list_tiffs(folder)) or any(
        sniff(_volume_file.read_first_bytes(path, HEAD)) for path in _volume_file.list_files(folder)
    )


def is_recognised(path: Path) -> bool:
    """Return whether the first bytes of a file are those of a format."""
    head = _volume_file.read_first_bytes(path, HEAD)
    return any(module.sniff(head) for module in list_formats())


def read_header(file: VolumeFile) -> StoredVolume:
    """Recognise a file's format, and read its header by the module of this format."""
    stored: StoredVolume = _choose_format(file).read_header(file)
    return stored


def _choose_format(file: VolumeFile) -> ModuleType:
    """Return the module of the format that recognises a file's content, or else its suffix.

    Raises `BrdfkitError` if the file is in no known format.
    """
    if file.path.is_dir():
        return _find_format_module(_volume_file.find_format_of_folder(file))
    if not (file.size is file.dtype is file.offset is None):  # only raw voxels need these settings
        return _find_format_module("raw")
    head, packed = _read_unpacked_head(file)
    sniffed = [module for module in list_formats() if module.sniff(head)]
    named = [m for m in list_formats() if str(file.path).lower().endswith(m.SUFFIXES)]
    for module in (*sniffed, *named):
        if packed and not any(suffix.endswith(".gz") for suffix in module.SUFFIXES):
            raise file.error(f"is {module.NAME} packed by gzip, which is not read; unpack it")
        return module
    problem = f"is in no known format of volumes; the known formats are {describe_formats()}"
    raise UnknownFormatError(str(file.error(problem)))


def _find_format_module(name: str) -> ModuleType:
    """Return the module of this folder that reads the format `name`, such as "dicom"."""
    return next(module for module in list_formats() if module.__name__.endswith(f".{name}"))


def _read_unpacked_head(file: VolumeFile) -> tuple[bytes, bool]:
    """Return the first `HEAD` bytes of a file, unpacked, and whether gzip had packed the file."""
    try:
        with file.path.open("rb") as stream:
            head = stream.read(HEAD)
        if not head:
            raise file.error("the file is empty; save or fetch it again")
        packed = head.startswith(b"\x1f\x8b")
        if packed:
            with gzip.open(file.path) as stream:
                head = stream.read(HEAD)
    except (EOFError, zlib.error, gzip.BadGzipFile) as error:
        raise file.error(
            f"the compressed data are damaged ({error}); save or fetch it again"
        ) from error
    except OSError as error:
        raise BrdfkitError(f"{file.path}: cannot be read ({error.strerror}).") from error
    return head, packed
