"""Tensors that are searched: texels of textures and environment maps, voxels of volumes."""

import numpy as np

from brdfkit.core.errors import BrdfkitError


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
