"""Linear sRGB, as Mitsuba and the pictures use it."""

import numpy as np

from brdfkit.errors import BrdfkitError

RGB = ("R", "G", "B")  # names of the channels
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def luminance(values):
    """Luminance (...) of values (..., 1), achromatic, or (..., 3), linear sRGB.

    >>> luminance(np.array([0.0, 1.0, 0.0]))
    np.float64(0.7152)
    """
    channels = values.shape[-1]
    if channels not in (1, 3):
        raise BrdfkitError(
            f"Values with {channels} channels have no luminance; convert them to RGB first."
        )
    return values[..., 0] if channels == 1 else values @ LUMINANCE


def colour_science():
    """The package `colour`, imported without its change of how NumPy prints arrays."""
    with np.printoptions():
        import colour
    return colour
