"""The file formats: one file of this folder each; `load` and `save` find them by being there.

A format module offers

- ``NAME``: for people; ``SUFFIXES``: such as ``(".binary",)``;
- ``sniff(head)``: whether the first 4 kB (bytes, decompressed) look like it;
- ``read(source)``: what the file holds, from a `Source`;
- ``write(obj, stream)``, where it can: into a binary stream; a `BrdfkitError` says what it
  cannot hold, and `save` puts the path before it;
- ``MANY = True``, where one file holds many samples and ``source.sample`` names one.

A module whose name begins with an underscore is no format.
"""

import gzip
import importlib
import lzma
import os
import pkgutil
from contextlib import contextmanager
from functools import cache
from pathlib import Path

from brdfkit.catalogue import public, shipped
from brdfkit.errors import BrdfkitError
from brdfkit.files import COMPRESSED, GZIP, contents, written
from brdfkit.formats._source import Source, format_suffix

HEAD = 4096  # bytes that a format's `sniff` sees


def load(path):
    """What the file at `path` (str or Path) holds: a `Measured` or a saved `Fit`.

    The content decides the format; the suffix decides between formats that all, or none,
    recognise it. ``.gz`` and ``.xz`` are unpacked. ``abrdf.dat#1`` names a sample of a file
    that holds many. Where there is no such file, the name of a known material stands for its
    file: of one that comes with brdfkit, ``car_paint``, or of one in a public collection, as
    ``merl/alum-bronze``, once `brdfkit data get` has downloaded it. Raises `BrdfkitError` with
    one sentence for every file that cannot be read.

    >>> print(load("gold-metallic-paint.binary.xz"))  # doctest: +SKIP
    gold-metallic-paint: 90×90×180 table, 1,048,000 of 1,458,000 valid, channels R G B
    """
    path, sample = _split(path)
    if not os.path.isfile(path):  # False, too, for what no path can be
        path = _known(path.as_posix()) or path
    return _read(Source(path, sample, contents(path)))


def save(obj, path):
    """Write `obj` to `path` in the format of its suffix, whole or not at all.

    `obj`: a `Measured`, a `Fit`, or for ``.bsdf`` also a model with values.

    ``.gz`` and ``.xz`` behind the suffix compress. Raises `BrdfkitError` when no format writes
    that suffix, the format cannot hold `obj`, or the folder cannot be written.

    >>> save(load("copper.astm"), "copper.binary.xz")  # doctest: +SKIP
    """
    with written(path) as beside:
        _write(obj, Path(path), beside)


def saved(obj, path):
    """`save`, and what the file holds: nothing is written that could not be read again.

    >>> saved(load("copper.astm"), "copper.npz").name  # doctest: +SKIP
    'copper'
    """
    with written(path) as beside:
        _write(obj, Path(path), beside)
        try:
            return _read(Source(Path(path), None, contents(beside)))
        except BrdfkitError as error:
            reason = str(error).removeprefix(f"{beside}: ").removeprefix(f"{path}: ")
            raise BrdfkitError(
                f"{path}: the file could not be read again ({reason.rstrip('.')})."
            ) from error


def _write(obj, path, beside):
    """Writes into the file `beside` what is to stand at `path`."""
    writers = [module for module in formats() if hasattr(module, "write")]
    chosen = [module for module in writers if format_suffix(path) in module.SUFFIXES]
    if not chosen:
        raise BrdfkitError(f"{path}: no format with this suffix; written are {_listed(writers)}.")
    with _compressing(beside) as stream:
        try:
            chosen[0].write(obj, stream)
        except BrdfkitError as error:
            raise BrdfkitError(f"{path}: {error}") from error


def _read(source):
    chosen = _recognised(source)
    if source.sample is not None and not getattr(chosen, "MANY", False):
        raise source.error(f"holds one material; leave '#{source.sample}' off the path")
    return chosen.read(source)


def _known(name):
    """The file of a known material, None where the name is none."""
    if name in shipped.materials():
        return shipped.path(name)
    if name.partition("/")[0] in shipped.index()["collections"] and "/" in name:
        return public.path(name)
    return None


@cache
def formats():
    """The format modules of this folder, in alphabetical order."""
    names = sorted(m.name for m in pkgutil.iter_modules(__path__) if not m.name.startswith("_"))
    return tuple(importlib.import_module(f"{__name__}.{name}") for name in names)


def has_format(path):
    """Whether the suffix of a `Path` is that of a format."""
    return any(format_suffix(path) in module.SUFFIXES for module in formats())


def _split(path):
    """The path and the sample named behind its last '#', unless that is part of the name."""
    path = Path(path)
    name, hash_sign, sample = path.name.rpartition("#")
    if not hash_sign or not name or os.path.exists(path):
        return path, None
    return path.with_name(name), sample


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
