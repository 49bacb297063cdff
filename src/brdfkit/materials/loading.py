"""`load` and `save`: materials and fits in files of any format, or known by name."""

from __future__ import annotations

import os
from pathlib import Path

from brdfkit.core import catalogue
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import read_bytes, write_safely
from brdfkit.core.locate import find_file_or_name, split_file_and_part
from brdfkit.materials import formats
from brdfkit.materials.collections import public
from brdfkit.materials.measured import Measured
from brdfkit.model import Model
from brdfkit.regression import Fit


def load(
    path: str | Path, *, mirror_azimuth: bool = False, divide_by_cos: bool = False
) -> Measured | Fit:
    """Load a measured material, or a saved fit, from a file of any known format.

    The content decides the format; the suffix decides where several formats, or none, recognise the
    content. ``.gz`` and ``.xz`` are unpacked.

    Parameters
    ----------
    path : str or Path
        The file. ``abrdf.dat#1`` names one sample of a file that holds many. Where there is no such
        file, the name of a material that comes with brdfkit, ``car_paint``, or of a material in a
        public collection, ``merl/alum-bronze``, once ``brdfkit data get`` has downloaded it.
    mirror_azimuth : bool, default False
        Whether 180° is added to every phi_o of samples, for a file with the mirror direction at
        phi_o = phi_i.
    divide_by_cos : bool, default False
        Whether the values of samples are divided by cos theta_o, for a file that has the BRDF times
        this cosine and does not say so.

    Returns
    -------
    Measured or Fit
        The content of the file.

    Raises
    ------
    BrdfkitError
        For a file that cannot be read, with the reason and the remedy; and where one of the last
        two arguments is True for a fit, a table or a format that states its own convention.

    Examples
    --------
    >>> print(load("gold-metallic-paint.binary.xz"))    # doctest: +SKIP
    gold-metallic-paint: 90×90×180 table, 1,048,000 of 1,458,000 valid, channels R G B
    """
    content = read(*locate(path))
    if not (mirror_azimuth or divide_by_cos):
        return content
    if not isinstance(content, Measured):
        raise BrdfkitError(f"{path}: is a saved fit, which needs no mending; leave the option out.")
    return content.mend(mirror_azimuth, divide_by_cos)


def locate(path: str | Path) -> tuple[Path, str | None]:
    """Return the file that `load` reads for a path or a name, and the sample named behind '#'.

    The sample is None where none is named. Raises `BrdfkitError` where there is neither a file nor
    a material of that name.

    >>> locate("dusty_gold")[0].name
    'dusty_gold.binary.xz'
    """
    if not str(path):
        raise BrdfkitError("The path is empty; name a file, or a material that brdfkit knows.")
    file, sample = split_file_and_part(path)
    collection, slash, _ = file.as_posix().partition("/")
    if slash and collection in catalogue.read_index()["collections"] and not os.path.isfile(file):
        return public.find_file(file.as_posix()), sample
    place = find_file_or_name(file, "material", catalogue.list_materials())
    return (catalogue.find_material_file(place) if isinstance(place, str) else place), sample


def read(path: Path, sample: str | None = None) -> Measured | Fit:
    """Return the content of the file at `path`; `sample` names one in a file that holds many."""
    content: Measured | Fit = formats.read(formats.Source(path, sample, read_bytes(path)))
    return content


def save(material: Measured | Fit | Model, path: str | Path) -> None:
    """Write a material to a file in the format of its suffix, whole or not at all.

    Parameters
    ----------
    material : Measured, Fit or Model
        The material: a measured one in any format that can hold it, a fit as ``.json``, and each
        of them, or a model with values, as ``.bsdf`` for Mitsuba's own plugin `measured`.
    path : str or Path
        The file; the suffix chooses the format, and ``.gz`` or ``.xz`` after it compress.

    Raises
    ------
    BrdfkitError
        Where no format has that suffix, or it cannot hold `material`, and where the file cannot be
        written.

    Examples
    --------
    >>> save(load("copper.astm"), "copper.binary.xz")    # doctest: +SKIP
    """
    if not isinstance(path, str | Path):
        raise BrdfkitError(
            f"{path!r:.60} is no path of a file to write; the order is save(material, path)."
        )
    with write_safely(path) as beside:
        formats.write(material, Path(path), beside)


def save_and_read(obj: Measured, path: str | Path) -> Measured:
    """Save a material, and return it as `load` reads it again; if it cannot, nothing is written.

    >>> save_and_read(load("copper.astm"), "copper.npz").name  # doctest: +SKIP
    'copper'
    """
    with write_safely(path) as beside:
        formats.write(obj, Path(path), beside)
        try:
            content: Measured = formats.read(formats.Source(Path(path), None, read_bytes(beside)))
            return content
        except BrdfkitError as error:
            reason = str(error).removeprefix(f"{beside}: ").removeprefix(f"{path}: ")
            raise BrdfkitError(
                f"{path}: the file could not be read again ({reason.rstrip('.')})."
            ) from error
