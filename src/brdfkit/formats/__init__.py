"""The file formats: one file is one format, found by its being there.

A format module offers

- ``NAME``: for people; ``SUFFIXES``: such as ``(".binary",)``;
- ``sniff(head)``: whether the first 4 kB (bytes, decompressed) look like it;
- ``read(source)``: what the file holds, from a `Source`;
- ``write(obj, stream)``, where it can: into a binary stream; a `BrdfkitError` says what it
  cannot hold, and `save` puts the path before it;
- ``MANY = True``, where one file holds many samples and ``source.sample`` names one.

What several share is in `_writing.py` and `_notes.py`, what `read` is given in `_source.py`.
"""

import gzip
import importlib
import lzma
import pkgutil
from contextlib import contextmanager
from functools import cache

from brdfkit.errors import BrdfkitError
from brdfkit.files import COMPRESSED, GZIP
from brdfkit.formats._source import Source as Source
from brdfkit.formats._source import format_suffix

HEAD = 4096  # bytes that a format's `sniff` sees


@cache
def formats():
    """The format modules of this folder, in alphabetical order."""
    names = sorted(m.name for m in pkgutil.iter_modules(__path__) if not m.name.startswith("_"))
    return tuple(importlib.import_module(f"{__name__}.{name}") for name in names)


def has_format(path):
    """Whether the suffix of a `Path` is that of a format."""
    return any(format_suffix(path) in module.SUFFIXES for module in formats())


def write(obj, path, beside):
    """Write `obj` in the format of `path`, but into the file `beside` it (both `Path`)."""
    writers = [module for module in formats() if hasattr(module, "write")]
    chosen = [module for module in writers if format_suffix(path) in module.SUFFIXES]
    if not chosen:
        raise BrdfkitError(f"{path}: no format with this suffix; written are {_listed(writers)}.")
    with _compressing(beside) as stream:
        try:
            chosen[0].write(obj, stream)
        except BrdfkitError as error:
            raise BrdfkitError(f"{path}: {error}") from error


def read(source):
    """What a `Source` holds, by the format that recognises it."""
    chosen = _recognised(source)
    if source.sample is not None and not getattr(chosen, "MANY", False):
        raise source.error(f"holds one material; leave '#{source.sample}' off the path")
    return chosen.read(source)


def _recognised(source):
    sniffed = [module for module in formats() if module.sniff(source.data[:HEAD])]
    named = [m for m in sniffed or formats() if source.suffix in m.SUFFIXES]
    # two formats are called .dat: a sample that is named tells them apart
    named.sort(key=lambda m: getattr(m, "MANY", False) != (source.sample is not None))
    if len(sniffed) == 1:
        return sniffed[0]
    if named:  # where none recognises it, its reader says what is wrong
        return named[0]
    if sniffed:
        raise source.error(f"could be {_listed(sniffed)}; rename it to one of these suffixes")
    raise source.error(
        f"is in no known format; read are {_listed(formats())}, each also as .gz or .xz"
    )


def _listed(modules):
    return ", ".join(f"{module.NAME} ({' '.join(module.SUFFIXES)})" for module in modules)


@contextmanager
def _compressing(path):
    """A binary stream into `path` that compresses by its suffix; equal input, equal bytes."""
    with path.open("wb") as raw:
        if path.suffix.lower() not in COMPRESSED:
            yield raw
        elif path.suffix.lower() == GZIP:
            with gzip.GzipFile(filename="", mode="wb", fileobj=raw, mtime=0) as stream:
                yield stream
        else:
            with lzma.open(raw, "wb", preset=1) as stream:
                yield stream
