"""Reads and writes the file formats of materials; each module of this folder is one format.

A new module is found without registration. It defines

- ``NAME``: the format's name for people; ``SUFFIXES``: its suffixes, such as ``(".binary",)``;
- ``sniff(head)``: returns whether the first 4 kB (bytes, decompressed) look like this format;
- ``read(source)``: returns the content of a `Source` (`_source.py`), a `Measured` or a `Fit`;
- ``write(obj, stream)``, if the format can be written: writes `obj` to a binary stream, or raises a
  `BrdfkitError` that says what the format cannot hold, to which the path is added;
- ``MANY = True``, if one file holds many materials: ``source.sample`` names one of them.

`_writing.py` has functions that several writers share, and `_delimited.py` reads tables of text.
"""

import gzip
import lzma
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import IO, Any

from brdfkit.core.discovery.plugin_files import import_modules
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import COMPRESSED, GZIP, XZ
from brdfkit.materials.formats._source import Source as Source
from brdfkit.materials.formats._source import find_format_suffix

HEAD = 4096  # number of a file's first bytes by which a format recognises the file


@cache
def list_formats() -> tuple[ModuleType, ...]:
    """Import the modules of all file formats, and return them in alphabetical order."""
    return import_modules(__name__, __path__)


def has_format(path: Path) -> bool:
    """Return whether a path has the suffix of a known file format."""
    return any(find_format_suffix(path) in module.SUFFIXES for module in list_formats())


def is_recognised(path: Path) -> bool:
    """Return whether the first bytes of a file, decompressed, are those of a format."""
    openers: dict[str, Any] = {GZIP: gzip.open, XZ: lzma.open}
    try:
        with openers.get(path.suffix.lower(), open)(path, "rb") as stream:
            head = stream.read(HEAD)
    except (OSError, EOFError, lzma.LZMAError):  # of a damaged file, or one that is not compressed
        return False
    return any(module.sniff(head) for module in list_formats())


def describe_formats() -> str:
    """Return the names of the formats with their suffixes."""
    return _list_format_names(list_formats())


def write(obj: Any, path: Path, beside: Path) -> None:
    """Write a material in the format that the suffix of `path` names, to the file `beside`.

    `beside` is a temporary file, which the caller moves to `path` when it is complete.
    """
    writers = [module for module in list_formats() if hasattr(module, "write")]
    suitable = [module for module in writers if find_format_suffix(path) in module.SUFFIXES]
    if not suitable:
        raise BrdfkitError(
            f"{path}: no format with this suffix; written are {_list_format_names(writers)}."
        )
    with _open_for_writing(beside) as stream:
        try:
            suitable[0].write(obj, stream)
        except BrdfkitError as error:
            raise BrdfkitError(f"{path}: {error}") from error


def read(source: Source) -> Any:
    """Return the material or fit in a file, read in the format that recognises the file."""
    module = _recognise_format(source)
    if source.sample is not None and not getattr(module, "MANY", False):
        raise source.error(f"holds one material; leave '#{source.sample}' off the path")
    return module.read(source)


def _recognise_format(source: Source) -> ModuleType:
    """Return the module of a file's format.

    The content decides; where several formats recognise it, or none does, the suffix decides.
    """
    sniffed = [module for module in list_formats() if module.sniff(source.data[:HEAD])]
    named = [m for m in sniffed or list_formats() if source.suffix in m.SUFFIXES]
    # Two formats have the suffix .dat: choose the one whose files hold many materials if the path
    # names one of them, otherwise the other
    named.sort(key=lambda m: getattr(m, "MANY", False) != (source.sample is not None))
    if len(sniffed) == 1:
        return sniffed[0]
    if named:  # the suffix decides; if the content does not fit, the reader says what is wrong
        return named[0]
    if sniffed:
        raise source.error(
            f"could be {_list_format_names(sniffed)}; rename it to one of these suffixes"
        )
    raise source.error(
        "is in no known format of materials; read are "
        f"{describe_formats()}, each also as .gz or .xz"
    )


def _list_format_names(modules: Iterable[ModuleType]) -> str:
    return ", ".join(f"{module.NAME} ({' '.join(module.SUFFIXES)})" for module in modules)


@contextmanager
def _open_for_writing(path: Path) -> Iterator[IO[bytes]]:
    """Open a binary stream that writes to `path`, compressed if its suffix is .gz or .xz.

    Equal input gives equal bytes, because no time or name is stored.
    """
    with path.open("wb") as raw:
        if path.suffix.lower() not in COMPRESSED:
            yield raw
        elif path.suffix.lower() == GZIP:
            with gzip.GzipFile(filename="", mode="wb", fileobj=raw, mtime=0) as stream:
                yield stream  # type: ignore[misc]  # mypy does not accept a GzipFile as an IO
        else:
            with lzma.open(raw, "wb", preset=1) as compressed:
                yield compressed
