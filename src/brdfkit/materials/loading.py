"""`load` and `save`: read materials and fits from files or by name, and write them to files."""

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

    The content of the file decides its format. Where several formats recognise the content, or none
    does, the suffix decides. Files that end in ``.gz`` or ``.xz`` are decompressed.

    Parameters
    ----------
    path : str or Path
        The file; ``abrdf.dat#1`` names one sample of a file that holds many. It may also be the
        name of a material that comes with brdfkit, ``car_paint``, or of a material of a public
        collection that ``brdfkit data get`` has downloaded, ``merl/alum-bronze``.
    mirror_azimuth : bool, default False
        Whether to add 180° to the azimuth phi_o of every view, for a file in which the mirror
        direction is at phi_o = phi_i.
    divide_by_cos : bool, default False
        Whether to divide the values by cos theta_o, for a file that stores the BRDF times this
        cosine without saying so.

    Returns
    -------
    Measured or Fit
        The content of the file.

    Raises
    ------
    BrdfkitError
        For a file that cannot be read, with the reason and the remedy. Also where one of the last
        two arguments is True, but the file holds a fit or a table, or its format fixes the
        convention.

    Examples
    --------
    >>> print(load("gold-metallic-paint.binary.xz"))    # doctest: +SKIP
    gold-metallic-paint: 90×90×180 table, 1,048,000 of 1,458,000 valid, channels R G B
    """
    file, sample = locate_material(path)
    content: Measured | Fit = formats.read(formats.Source(file, sample, read_bytes(file)))
    if not (mirror_azimuth or divide_by_cos):
        return content
    if not isinstance(content, Measured):
        raise BrdfkitError(
            f"{path}: is a saved fit, but mirror_azimuth and divide_by_cos convert measured "
            "samples; leave the option out."
        )
    return content.mend(mirror_azimuth, divide_by_cos)


def locate_material(path: str | Path) -> tuple[Path, str | None]:
    """Return the path of the file that `load` reads for a path or a material's name.

    The second result is the text behind '#' in `path`, which names one of several samples in the
    file, or None. Raises `BrdfkitError` where there is neither a file nor a material of that name.

    >>> locate_material("dusty_gold")[0].name
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


def save(material: Measured | Fit | Model, path: str | Path) -> None:
    """Write a material to a file, in the format that the file's suffix names.

    Where an error or Ctrl-C ends the writing, no incomplete file is left.

    Parameters
    ----------
    material : Measured, Fit or Model
        The material. A measured one can be written in most formats, a fit as ``.json``. Measured
        materials, fits and models can all be written as ``.bsdf``, for Mitsuba's plugin `measured`.
    path : str or Path
        The file; its suffix chooses the format, and ``.gz`` or ``.xz`` behind that compresses it.

    Raises
    ------
    BrdfkitError
        For a suffix of no known format, for a format that cannot hold `material`, and for a file
        that cannot be written.

    Examples
    --------
    >>> save(load("copper.astm"), "copper.binary.xz")    # doctest: +SKIP
    """
    if not isinstance(path, str | Path):
        raise BrdfkitError(
            f"{path!r:.60} is not the path of a file to write; give the material first: "
            "save(material, path)."
        )
    with write_safely(path) as beside:
        formats.write(material, Path(path), beside)


def save_and_read(obj: Measured, path: str | Path) -> Measured:
    """Save a measured material, and return what `load` reads from the file, to compare the two.

    Raises `BrdfkitError`, and leaves no file, where the file cannot be read again.

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
