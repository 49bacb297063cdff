"""Reads pictures by Mitsuba, whatever their format: their pixels in linear sRGB."""

from pathlib import Path

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.mitsuba_bridge.properties.load_by_mitsuba import load_by_mitsuba
from brdfkit.mitsuba_bridge.properties.radiance_rows import require_rows

LINEAR = ".exr", ".hdr", ".pfm", ".rgbe"  # files without a curve for screens


def read_photograph(path, linearise):
    """The linear pixels (height, width, 3) of a photograph.

    Raises `BrdfkitError` where there is none, for a file that Mitsuba cannot read, and for one of 8
    bits, unless it is to `linearise` by sRGB's curve.
    """
    if Path(path).suffix.lower() not in LINEAR and not linearise:
        raise BrdfkitError(
            f"{path}: such files hold 8 bits, or 16, behind a curve for screens; give an OpenEXR "
            "file, or say linearise=True (--linearise), for sRGB's curve."
        )
    if not Path(path).is_file():
        raise BrdfkitError(f"{path}: there is no such picture; check the path.")
    return read_pixels(path, str(path))


def read_pixels(path, name):
    """The pixels (height, width, 3) of the picture in a file, which errors call `name`.

    Raises `BrdfkitError` for a file that Mitsuba cannot read, because it is cut off, for instance.
    """
    import mitsuba as mi

    if Path(path).is_file():
        require_rows(path, name)
    return load_by_mitsuba(lambda file, parallel: pixels_of(mi.Bitmap(file)), str(path), name)


def pixels_of(bitmap):
    """The pixels (height, width, 3) of a `mitsuba.Bitmap`."""
    import mitsuba as mi

    kind = mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32
    return np.array(bitmap.convert(*kind, srgb_gamma=False))
