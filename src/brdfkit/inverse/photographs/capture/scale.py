"""Finds the size of a pixel at an object, and the distance of the camera, from what is known.

A camera whose focal length is f pixels, at the distance d, shows lengths of d / f in a pixel.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from brdfkit.core.array_types import BoolArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.inverse.photographs.capture.listing import Listing
from brdfkit.inverse.photographs.capture.pinhole import check_fov

EXIF_IFD, FOCAL_LENGTH_IN_35_MM = 0x8769, 41989  # tags of EXIF
FILM_DIAGONAL = 43.27  # mm, of 35 mm film


def find_scale(
    listing: Listing, mask: BoolArray
) -> tuple[float | None, float | None, tuple[str, ...]]:
    """Return the size of a pixel [m], the distance of the camera [m], and notes on them.

    Both are None where they are unknown. `mask` (height, width) shows the object. Raises
    `BrdfkitError` if lamps have positions in metres, and the size of a pixel is unknown.
    """
    pixel_size, distance = listing.pixel_size, listing.distance
    notes: tuple[str, ...] = ()
    if listing.width is not None:
        pixel_size = listing.width / (1 + float(np.ptp(np.nonzero(mask)[1])))
    if (pixel_size is None) != (distance is None):
        focal_length, notes = _find_focal_length(listing, mask.shape)
        if focal_length is not None and distance is not None:
            pixel_size = distance / focal_length
        elif focal_length is not None and pixel_size is not None:
            distance = pixel_size * focal_length
    if listing.lights.positions is not None and pixel_size is None:
        raise BrdfkitError(
            f"{listing.lights_file}: lamps have positions in metres, but the size of the object "
            "is not known; give [object] width, or pixel_size, in metres."
        )
    # A distance without a scale says nothing about perspective
    return pixel_size, None if pixel_size is None else distance, notes


def _find_focal_length(
    listing: Listing, shape: tuple[int, ...]
) -> tuple[float | None, tuple[str, ...]]:
    """Return the focal length of the camera [pixels], None if it is unknown, and notes on it."""
    if listing.fov is not None:
        check_fov(listing.fov)
        return shape[1] / 2 / np.tan(np.radians(listing.fov) / 2), ()
    path = listing.photographs[0]
    length = read_focal_length(path)
    if length is None:
        return None, ()
    note = f"the focal length is {length:g} mm of 35 mm film, as EXIF in {path.name} states."
    return length / FILM_DIAGONAL * float(np.hypot(shape[0], shape[1])), (note,)


def read_focal_length(path: Path) -> float | None:
    """Return the focal length that is equivalent on 35 mm film [mm], from EXIF; None without it."""
    from PIL import Image

    try:
        with Image.open(path) as picture:
            length = picture.getexif().get_ifd(EXIF_IFD).get(FOCAL_LENGTH_IN_35_MM)
    except (OSError, ValueError, SyntaxError):  # a format without EXIF, such as OpenEXR
        return None
    return float(length) if isinstance(length, int | float) and length > 0 else None
