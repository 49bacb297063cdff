"""Tensors that are searched: texels of textures and environment maps, voxels of volumes."""

import numpy as np

from brdfkit.core.errors import BrdfkitError


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


def is_tensor(value):
    """Whether an entry of a scene is a tensor."""
    import drjit as dr

    return bool(dr.is_tensor_v(value))


def places(parameters, key):
    """Which number (height, width, ...) each texel of the tensor `key` shows.

    Mitsuba's environment maps repeat their last column before the first, and their first one
    after the last; of others every texel is a number of its own.

    Raises `BrdfkitError` for a tensor that is not of 32-bit floats.
    """
    import mitsuba as mi

    value = parameters[key]
    if type(value) is not mi.TensorXf:
        raise BrdfkitError(
            f"{key}: its texels ({type(value).__name__}) are no numbers of 32 bits to search; load "
            'the texture from a mitsuba.Bitmap of floats, or with "format": "fp32".'
        )
    if not np.prod(value.shape):
        raise BrdfkitError(f"{key}: it is empty.")
    if not wraps(parameters, key):
        return np.arange(np.prod(value.shape)).reshape(value.shape)
    height, width, channels = value.shape
    inner = np.arange(height * (width - 2) * channels).reshape(height, width - 2, channels)
    return np.pad(inner, ((0, 0), (1, 1), (0, 0)), mode="wrap")


def wraps(parameters, key):
    """Whether the columns of a tensor go around: those of Mitsuba's environment maps."""
    owner = parameters.properties[key][2]
    return hasattr(owner, "class_name") and owner.class_name() == "EnvironmentMapEmitter"


def numbers_of(value, places):
    """The numbers (n,) of a tensor."""
    found = np.empty(places.max() + 1)
    found[places.ravel()] = np.array(value, float).ravel()
    return found


def shape_of(places, around):
    """The shape of the numbers, without what is repeated."""
    height, width, *rest = places.shape
    return (height, width - 2, *rest) if around else places.shape


def tensor_of(numbers, places):
    """Mitsuba's tensor of numbers (n,)."""
    import mitsuba as mi

    return mi.TensorXf(np.float32(np.ravel(numbers)[places]))
