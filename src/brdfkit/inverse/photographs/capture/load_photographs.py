"""Loads a folder of photographs, whatever its kind: of a flat sample, or of an object."""

from __future__ import annotations

from pathlib import Path

from brdfkit.core.errors import BrdfkitError
from brdfkit.inverse.photographs.capture.capture import Capture
from brdfkit.inverse.photographs.capture.capture_file import NAME as CAPTURE_FILE
from brdfkit.inverse.photographs.capture.capture_file import load_capture
from brdfkit.inverse.photographs.capture.folders import find_listing
from brdfkit.inverse.photographs.capture.object_capture import ObjectCapture
from brdfkit.inverse.photographs.capture.pictures.coding import to_coding
from brdfkit.inverse.photographs.capture.reading import read_object


def load_photographs(
    folder: str | Path, linearise: str | float | None = None
) -> Capture | ObjectCapture:
    """Load the photographs in a folder, with their lights, by the kind of the folder.

    Parameters
    ----------
    folder : path
        A folder with ``capture.toml``, one of DiLiGenT, or one of the other kinds that
        docs/how_to/photographs.md lists.
    linearise : str or float, optional
        How photographs of 8 bits are coded: "linear" if their numbers are in proportion to light,
        "sRGB", "gamma" (2.2), or the exponent of a gamma. They are refused without it.

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
    folder, coding = Path(folder), to_coding(linearise)
    if not folder.is_dir():
        raise BrdfkitError(f"{folder}: there is no such folder; check the path.")
    if (folder / CAPTURE_FILE).is_file():
        return load_capture(folder, accept_8_bit=coding is not None)
    listing = find_listing(folder)
    if listing is None:
        raise BrdfkitError(
            f"{folder}: there is no {CAPTURE_FILE} in it, and it is no folder of another kind that "
            "says where the lights are; see docs/how_to/photographs.md."
        )
    return read_object(listing, coding)
