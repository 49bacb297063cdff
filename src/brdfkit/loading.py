"""`load` and `save`: materials and fits in files of any format, or known by name."""

import os
from pathlib import Path

from brdfkit import formats
from brdfkit.catalogue import index, public, shipped
from brdfkit.errors import BrdfkitError
from brdfkit.files import contents, written


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
    if not str(path):
        raise BrdfkitError("The path is empty; name a file, or a material that brdfkit knows.")
    path, sample = _split(path)
    if not os.path.isfile(path):  # False, too, for what no path can be
        path = _known(path.as_posix()) or path
    return formats.read(formats.Source(path, sample, contents(path)))


def save(obj, path):
    """Write `obj` to `path` in the format of its suffix, whole or not at all.

    `obj`: a `Measured`, a `Fit`, or for ``.bsdf`` also a model with values.

    ``.gz`` and ``.xz`` behind the suffix compress. Raises `BrdfkitError` when no format writes
    that suffix, the format cannot hold `obj`, or the folder cannot be written.

    >>> save(load("copper.astm"), "copper.binary.xz")  # doctest: +SKIP
    """
    with written(path) as beside:
        formats.write(obj, Path(path), beside)


def save_and_read(obj, path):
    """`save`, and what the file holds: nothing is written that could not be read again.

    >>> save_and_read(load("copper.astm"), "copper.npz").name  # doctest: +SKIP
    'copper'
    """
    with written(path) as beside:
        formats.write(obj, Path(path), beside)
        try:
            return formats.read(formats.Source(Path(path), None, contents(beside)))
        except BrdfkitError as error:
            reason = str(error).removeprefix(f"{beside}: ").removeprefix(f"{path}: ")
            raise BrdfkitError(
                f"{path}: the file could not be read again ({reason.rstrip('.')})."
            ) from error


def _known(name):
    """The file of a known material, None where the name is none."""
    if name in shipped.materials():
        return shipped.path(name)
    if name.partition("/")[0] in index.entries()["collections"] and "/" in name:
        return public.path(name)
    return None


def _split(path):
    """The path and the sample named behind its last '#', unless that is part of the name."""
    path = Path(path)
    name, hash_sign, sample = path.name.rpartition("#")
    if not hash_sign or not name or os.path.exists(path):
        return path, None
    return path.with_name(name), sample
