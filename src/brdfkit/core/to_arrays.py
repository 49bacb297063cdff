"""What users give as lists of numbers, as arrays: a wrong one is an error that names it."""

import numpy as np

from brdfkit.core.errors import BrdfkitError


def to_array(name, value, shape=None):
    """The array of floats, finite and of a `shape` where that is given; one of floats is itself."""
    try:
        found = np.asarray(value)
        if found.dtype not in (np.float32, np.float64):
            found = found.astype(float)
    except (TypeError, ValueError):
        raise BrdfkitError(f"{name}: they should be numbers, in lists of one length.") from None
    if shape is not None and found.shape != shape:
        raise BrdfkitError(f"{name}: their shape {found.shape} should be {shape}.")
    if shape is not None and not np.isfinite(found).all():
        raise BrdfkitError(f"{name}: they should be finite numbers.")
    return found


def to_place(name, point):
    """The array (3,) of a point above the sample."""
    found = to_array(name, point, (3,))
    if found[2] <= 0:
        raise BrdfkitError(f"{name} = {point!r} should be above the sample, its z [m] above 0.")
    return found


def to_intensity(given):
    """The array (1, 3) of an intensity."""
    found = to_array("intensity", given)
    if found.shape not in ((), (1,), (3,)) or not np.isfinite(found).all() or (found < 0).any():
        raise BrdfkitError(f"intensity = {given!r} should be a number, or three, 0 or above.")
    return np.broadcast_to(found, (1, 3))
