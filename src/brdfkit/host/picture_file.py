"""Reads pictures by Mitsuba, whatever their format: their pixels in linear sRGB."""

import numpy as np

from brdfkit.host.load_by_mitsuba import load_by_mitsuba


def read_pixels(path, name):
    """The pixels (height, width, 3) of the picture in a file, which errors call `name`.

    Raises `BrdfkitError` for a file that Mitsuba cannot read, because it is cut off, for instance.
    """
    import mitsuba as mi

    return load_by_mitsuba(lambda file, parallel: pixels_of(mi.Bitmap(file)), str(path), name)


def pixels_of(bitmap):
    """The pixels (height, width, 3) of a `mitsuba.Bitmap`."""
    import mitsuba as mi

    kind = mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32
    return np.array(bitmap.convert(*kind, srgb_gamma=False))
