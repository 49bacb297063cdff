"""The formats of volumes: every file of this folder is one, and is found by itself.

A format's file defines

- ``NAME``: the name for people; ``SUFFIXES``: such as ``(".nrrd", ".nhdr")``;
- ``sniff(head)``: whether the first 4 kB (bytes, unpacked if gzip) look like this format;
- ``find(file)``: what is in a `VolumeFile` (`_stored.py`), as `Stored`: the header alone is read,
  and the voxels layer by layer when they are asked for.

`_stored.py`, `_streams.py`, `_folders.py` and `_axes.py` have what several formats share. Packages
of one format each (nibabel, pynrrd, pydicom, tifffile) are imported when a file needs them.
"""

import gzip
import zlib
from functools import cache

from brdfkit.core.discovery.plugin_files import import_modules
from brdfkit.core.errors import BrdfkitError
from brdfkit.volumes.formats import _stored
from brdfkit.volumes.formats._stored import Stored as Stored
from brdfkit.volumes.formats._stored import VolumeFile as VolumeFile

HEAD = 4096  # bytes that a format's `sniff` sees


@cache
def formats():
    """The format modules of this folder, in alphabetical order."""
    return import_modules(__name__, __path__)


def has_format(name):
    """Whether a file's name ends as those of a format do."""
    return any(str(name).lower().endswith(module.SUFFIXES) for module in formats())


def is_series(folder):
    """Whether a folder holds a stack of TIFF, or a series of DICOM, of which one file is enough."""
    if not folder.is_dir():
        return False
    sniff = _of_name("dicom").sniff
    return bool(_stored.pictures(folder)) or any(
        sniff(_stored.head(path, HEAD)) for path in _stored.files(folder)
    )


def find(file):
    """The `Stored` of a `VolumeFile`, by the format that recognises it, else by its suffix."""
    if file.path.is_dir():
        return _of_name(_stored.kind(file)).find(file)
    if not (file.size is file.dtype is file.offset is None):  # what is told only of raw voxels
        return _of_name("raw").find(file)
    head, packed = _head(file)
    sniffed = [module for module in formats() if module.sniff(head)]
    named = [m for m in formats() if str(file.path).lower().endswith(m.SUFFIXES)]
    for module in (*sniffed, *named):
        if packed and not has_packed(module):
            raise file.error(f"is {module.NAME} packed by gzip, which is not read; unpack it")
        return module.find(file)
    known = ", ".join(f"{module.NAME} ({' '.join(module.SUFFIXES)})" for module in formats())
    raise file.error(f"is in no known format of volumes; read are {known}")


def has_packed(module):
    """Whether files of a format may be packed by gzip as a whole."""
    return any(suffix.endswith(".gz") for suffix in module.SUFFIXES)


def _of_name(name):
    return next(module for module in formats() if module.__name__.endswith(f".{name}"))


def _head(file):
    """The first bytes of a file, unpacked, and whether they were packed by gzip."""
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
