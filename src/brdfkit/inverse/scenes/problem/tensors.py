"""Converts entries of a scene, such as textures and volumes, to independent numbers, and back.

Mitsuba's environment maps store their first and last column twice, once at each end. A search has
to move a texel together with its copy, so it works on the independent numbers only.
"""

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray, IntArray, MitsubaObject
from brdfkit.core.errors import BrdfkitError


def is_tensor(value: MitsubaObject) -> bool:
    """Return whether the value of a scene entry is a tensor, as textures and volumes are."""
    import drjit as dr

    return bool(dr.is_tensor_v(value))


def index_numbers_by_texel(parameters: MitsubaObject, key: str) -> IntArray:
    """Return for each texel of the tensor `key` the index of the independent number that it holds.

    The result has the tensor's shape. Only environment maps of Mitsuba hold a number twice: their
    last column is repeated before the first one, and their first column after the last one. Raises
    `BrdfkitError` for a tensor that is empty or does not consist of 32-bit floats.
    """
    import mitsuba as mi

    value = parameters[key]
    if type(value) is not mi.TensorXf:
        raise BrdfkitError(
            f"{key}: its texels ({type(value).__name__}) are not 32-bit floats, which a search "
            'needs; load the texture from a mitsuba.Bitmap of floats, or with "format": "fp32".'
        )
    if not np.prod(value.shape):
        raise BrdfkitError(f"{key}: it is empty.")
    if not is_environment_map(parameters, key):
        return np.arange(np.prod(value.shape)).reshape(value.shape)
    height, width, channels = value.shape
    inner = np.arange(height * (width - 2) * channels).reshape(height, width - 2, channels)
    return np.pad(inner, ((0, 0), (1, 1), (0, 0)), mode="wrap")


def is_environment_map(parameters: MitsubaObject, key: str) -> bool:
    """Return whether a tensor is an environment map, whose last column is beside its first."""
    owner = parameters.properties[key][2]
    return hasattr(owner, "class_name") and owner.class_name() == "EnvironmentMapEmitter"


def read_tensor(value: MitsubaObject, texels: IntArray) -> FloatArray:
    """Return the independent numbers (n,) of a tensor.

    `texels`, in the tensor's shape, holds the index of the number that belongs to each texel.
    """
    numbers: FloatArray = np.empty(texels.max() + 1)
    numbers[texels.ravel()] = np.array(value, float).ravel()
    return numbers


def make_tensor(numbers: AnyArray, texels: IntArray) -> MitsubaObject:
    """Return the Mitsuba tensor that holds the given independent numbers.

    `texels`, in the tensor's shape, holds the index of the number that belongs to each texel.
    """
    import mitsuba as mi

    return mi.TensorXf(np.ravel(numbers)[texels].astype(np.float32))


def make_opaque_array(kind: type, values: AnyArray) -> MitsubaObject:
    """Return a Dr.Jit array of type `kind` whose numbers do not become constants of kernels.

    All values then share one kernel, which is compiled once.
    """
    import drjit as dr
    import mitsuba as mi

    numbers = [dr.opaque(mi.Float, float(v)) for v in values]
    return numbers[0] if len(numbers) == 1 and kind is mi.Float else kind(*numbers)


def find_independent_shape(texels: IntArray, wraps: bool) -> tuple[int, ...]:
    """Return the shape of a tensor without the two columns that an environment map repeats."""
    height, width, *others = texels.shape
    return (height, width - 2, *others) if wraps else texels.shape
