"""Loads a folder of photographs, whatever its kind: of a flat sample, or of an object."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.inverse.photographs.capture.capture import Capture
from brdfkit.inverse.photographs.capture.capture_file import load_capture
from brdfkit.inverse.photographs.capture.diagnosis.diagnose import find_coding, turn_lights
from brdfkit.inverse.photographs.capture.diagnosis.order import describe_misfit, order_lights
from brdfkit.inverse.photographs.capture.diagnosis.strengths import adapt_strengths
from brdfkit.inverse.photographs.capture.folders import find_listing
from brdfkit.inverse.photographs.capture.listing import Listing
from brdfkit.inverse.photographs.capture.making_lights import (
    check_spread,
    find_lights_in_front,
    make_distant_lights,
)
from brdfkit.inverse.photographs.capture.object_capture import ObjectCapture
from brdfkit.inverse.photographs.capture.pictures.coding import LINEAR, Coding, to_coding
from brdfkit.inverse.photographs.capture.pictures.masks import find_mask_file
from brdfkit.inverse.photographs.capture.pictures.photograph_file import (
    EightBitError,
    list_photographs,
)
from brdfkit.inverse.photographs.capture.reading import leave_out, read_object
from brdfkit.inverse.photographs.capture.toml_entries import NAME as CAPTURE_FILE
from brdfkit.inverse.photographs.capture.unknown_lights.estimate import FEWEST, estimate_lights
from brdfkit.materials.collections.public import find_folder

DOWNLOADED = "captures"  # name of the collection of photographs
# What Lambert's law says of the coding of photographs, which `find_coding` names
CODED_NOTE = (
    "the photographs seem to be coded with a gamma, as Lambert's law fits their values to the "
    "power of 2.2 much better; give linear ones, or --linearise sRGB."
)
DECODED_NOTE = (
    "the photographs seem to have been linear before a gamma was removed, as Lambert's law fits "
    "them much better then; --linearise linear keeps their numbers."
)
NOTES = {"coded": CODED_NOTE, "decoded": DECODED_NOTE}


def load_photographs(
    folder: str | Path, linearise: str | float | None = None
) -> Capture | ObjectCapture:
    """Load the photographs in a folder, with their lights, by the kind of the folder.

    Where no file says where the lights are, they are estimated from 6 photographs or more, and a
    note says so.

    Parameters
    ----------
    folder : path
        A folder with ``capture.toml``, one of DiLiGenT, or one of the other kinds that
        docs/how_to/photographs_of_objects.md lists; or the name of photographs that
        `brdfkit data get` downloaded, such as ``captures/cat``.
    linearise : str or float, optional
        How the numbers of photographs are coded: "linear" if they are in proportion to light,
        "sRGB", "gamma" (2.2), or the exponent of a gamma. Without it 16 bits are linear, and
        photographs of 8 bits are refused.

    Returns
    -------
    Capture or ObjectCapture
        Photographs of a flat sample, or of an object.

    Raises
    ------
    BrdfkitError
        For a folder of no known kind, and for files that are missing, damaged, or do not fit each
        other.

    Examples
    --------
    >>> load_photographs("pmsData/ballPNG").normals.shape    # doctest: +SKIP
    (15791, 3)
    """
    folder, coding = _find_folder(folder), to_coding(linearise)
    listing = find_listing(folder)
    if listing is not None:
        return load_object(listing, coding)
    if (folder / CAPTURE_FILE).is_file():
        return load_capture(folder, coding=coding)
    photographs = list_photographs(folder)
    if len(photographs) >= FEWEST:
        return _load_without_lights(folder, photographs, coding)
    if not photographs:
        parts = [part for part in sorted(folder.iterdir()) if part.is_dir()]
        found = next((f", such as {part}" for part in parts if list_photographs(part)), "")
        raise BrdfkitError(
            f"{folder}: there are no photographs in it; give the folder that has them{found}."
        )
    raise BrdfkitError(
        f"{folder}: there is no {CAPTURE_FILE} in it, nor another file that says where the lights "
        f"of its {len(photographs)} photographs are; add lights.txt, with x y z of each (right, "
        "up, to the camera)."
    )


def _find_folder(folder: str | Path) -> Path:
    """Return the path of a folder on this disk, also of one that `brdfkit data get` downloaded."""
    path = Path(folder)
    # Results of a fit may lie in a folder of that name
    if path.is_dir() and any(file.is_file() for file in path.iterdir()):
        return path
    if path.parts[:1] == (DOWNLOADED,) and len(path.parts) == 2:
        return find_folder(path.as_posix())
    if path.is_dir():
        return path
    raise BrdfkitError(f"{folder}: there is no such folder; check the path.")


def load_object(listing: Listing, coding: Coding | None) -> ObjectCapture:
    """Return the photographs of an object that `listing` describes, with notes on what is odd.

    `coding` tells how their numbers are coded. Raises the errors of `load_photographs`.
    """
    try:
        capture = _adapt_lights(read_object(listing, coding), listing)
    except EightBitError as error:
        capture = _adapt_lights(read_object(listing, Coding()), listing)
        word = "sRGB" if find_coding(capture) == "coded" else LINEAR
        raise EightBitError(
            f"{str(error).removesuffix('.')}; by Lambert's law they look like {word}."
        ) from None
    found = find_coding(capture)
    if found is None or (found == "decoded" and coding in (None, Coding())):
        return capture
    return replace(capture, notes=(*capture.notes, NOTES[found]))


def _load_without_lights(
    folder: Path, photographs: tuple[Path, ...], coding: Coding | None
) -> ObjectCapture:
    """Return the photographs of an object in a folder, with lights that are estimated from them."""
    towards_camera = np.tile([0.0, 0.0, 1.0], (len(photographs), 1))
    listing = Listing(
        name=folder.resolve().name,
        photographs=photographs,
        lights=make_distant_lights(folder, towards_camera),
        lights_file=folder,
        mask=find_mask_file(folder),
    )
    return estimate_lights(read_object(listing, coding), folder)


def _adapt_lights(capture: ObjectCapture, listing: Listing) -> ObjectCapture:
    """Return photographs with lights in their order and axes, and in front of the object."""
    path = listing.lights_file
    capture = turn_lights(order_lights(capture, listing), path)
    in_front = find_lights_in_front(path, capture.lights)
    capture = leave_out(capture, in_front, "lit from behind the object")
    check_spread(path, capture.lights)
    capture = adapt_strengths(capture, listing)
    return replace(capture, notes=(*capture.notes, *describe_misfit(capture)))
