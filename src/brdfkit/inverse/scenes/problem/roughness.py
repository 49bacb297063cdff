"""How rough tensors are: the mean squared difference of neighbouring texels."""

import numpy as np


def roughness(unknowns, parts):
    """(the sum of it over all tensors, its derivatives (n,)) at coordinates, the `parts`.

    Coordinates without an upper bound count relative to the mean at the start. Numbers that are no
    tensors have no neighbours.
    """
    total, slopes = 0.0, []
    for unknown, part in zip(unknowns, parts, strict=True):
        if unknown.shape:
            scale = _scale(unknown)
            one, slope = _of_one(part.reshape(unknown.shape) / scale, unknown.around)
            total += one
            slopes.append(slope.ravel() / scale)
        else:
            slopes.append(np.zeros(len(part)))
    return total, np.concatenate(slopes)


def _scale(unknown):
    if np.isfinite(unknown.high):
        return 1.0
    return max(float(np.abs(unknown.coordinates(unknown.start)).mean()), 1e-6)


def _of_one(values, around):
    """Of one tensor (..., channels), its second axis a circle where it goes `around`."""
    total, slope = 0.0, np.zeros_like(values)
    for axis in range(values.ndim - 1):
        change = np.roll(values, -1, axis) - values
        if not (around and axis == 1):
            np.moveaxis(change, axis, 0)[-1] = 0
        total += (change**2).sum() / values.size
        slope += 2 * (np.roll(change, 1, axis) - change) / values.size
    return total, slope
