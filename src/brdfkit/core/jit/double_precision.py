"""Double precision with Dr.Jit: the arrays in which models are evaluated and fitted.

With LLVM (or CUDA) a kernel runs over all directions at once and has derivatives. Without either,
Dr.Jit's scalar arrays do the same more slowly, and a fit takes finite differences.
"""

from dataclasses import dataclass
from functools import cache
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.jit import llvm
from brdfkit.core.jit.padding import pad


@dataclass(frozen=True)
class Vector:
    """Directions in a model's formula: x, y and z are arrays (n,) over all directions."""

    x: Any
    y: Any
    z: Any

    def __add__(self, other):
        return Vector(self.x + other.x, self.y + other.y, self.z + other.z)

    def __sub__(self, other):
        return Vector(self.x - other.x, self.y - other.y, self.z - other.z)

    def __neg__(self):
        return Vector(-self.x, -self.y, -self.z)

    def __mul__(self, factor):
        return Vector(self.x * factor, self.y * factor, self.z * factor)

    __rmul__ = __mul__


@cache
def float_type():
    """The array type: Dr.Jit's `Float64` of the LLVM or CUDA backend, else `ArrayXf64`."""
    import drjit as dr

    if llvm.loaded_version() >= llvm.OLDEST:
        return dr.llvm.ad.Float64
    if dr.has_backend(dr.JitBackend.CUDA):
        return dr.cuda.ad.Float64
    return dr.scalar.ArrayXf64


def has_derivatives():
    """True where `float64()` has derivatives."""
    import drjit as dr

    return bool(dr.is_diff_v(float_type()))


def to_array(values):
    """The NumPy array `values` (n,) as `float64()`."""
    return float_type()(pad(np.asarray(values, float)))


def to_vector(w):
    """A `Vector` of NumPy directions (n, 3)."""
    return Vector(*(to_array(w[:, k]) for k in range(3)))


def to_scalar(value):
    """A number as an array of size 1, opaque: a kernel does not contain it as a constant."""
    import drjit as dr

    number = float_type()(float(value))
    dr.make_opaque(number)
    return number


def to_shape_scalars(model):
    """The free shape parameters of a model with values, by name, each a `to_scalar`."""
    linear = model.weights()
    return {name: to_scalar(v) for name, v in model.free_values.items() if name not in linear}


def differentiate(function, x):
    """A function of arrays at `x`, and its derivative there."""
    if not has_derivatives():
        h = 1e-6 * dr.maximum(x, 1e-3)
        return function(x), (function(x + h) - function(x - h)) / (2 * h)
    dr.enable_grad(x)
    y = function(x)
    dr.forward_from(x)
    return dr.detach(y), dr.grad(y)
