"""Arrays of Dr.Jit in double precision, in which brdfkit evaluates and fits models.

With LLVM or CUDA one kernel runs over all directions at once and has derivatives. Without either,
Dr.Jit's scalar arrays compute the same more slowly, and a fit takes finite differences.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.array_types import ArrayLike, FloatArray, JitFloat
from brdfkit.core.jit import llvm
from brdfkit.core.jit.padding import pad


@dataclass(frozen=True)
class Vector:
    """Vectors of a model's formula: x, y and z are arrays (n,) over all directions."""

    x: Any
    y: Any
    z: Any

    def __add__(self, other: Vector) -> Vector:
        return Vector(self.x + other.x, self.y + other.y, self.z + other.z)

    def __sub__(self, other: Vector) -> Vector:
        return Vector(self.x - other.x, self.y - other.y, self.z - other.z)

    def __neg__(self) -> Vector:
        return Vector(-self.x, -self.y, -self.z)

    def __mul__(self, factor: JitFloat) -> Vector:
        return Vector(self.x * factor, self.y * factor, self.z * factor)

    __rmul__ = __mul__


@cache
def choose_float_type() -> type:
    """Return the array type: Dr.Jit's `Float64` of the LLVM or CUDA backend, else `ArrayXf64`."""
    import drjit as dr

    if llvm.find_loaded_version() >= llvm.OLDEST:
        return dr.llvm.ad.Float64
    if dr.has_backend(dr.JitBackend.CUDA):
        return dr.cuda.ad.Float64
    return dr.scalar.ArrayXf64


def has_derivatives() -> bool:
    """Return whether the arrays of `choose_float_type()` have derivatives."""
    import drjit as dr

    return bool(dr.is_diff_v(choose_float_type()))


def to_array(values: ArrayLike) -> JitFloat:
    """Convert a NumPy array (n,) to `choose_float_type()`."""
    return choose_float_type()(pad(np.asarray(values, float)))


def to_vector(w: FloatArray) -> Vector:
    """Convert NumPy directions (n, 3) to a `Vector`."""
    return Vector(*(to_array(w[:, k]) for k in range(3)))


def to_scalar(value: float) -> JitFloat:
    """Convert a number to an opaque array of size 1, which kernels do not contain as a constant."""
    import drjit as dr

    number = choose_float_type()(float(value))
    dr.make_opaque(number)
    return number


def differentiate(
    function: Callable[[JitFloat], JitFloat], x: JitFloat
) -> tuple[JitFloat, JitFloat]:
    """Return a function of arrays at `x` and its derivative there."""
    if not has_derivatives():
        h = 1e-6 * dr.maximum(x, 1e-3)
        return function(x), (function(x + h) - function(x - h)) / (2 * h)
    dr.enable_grad(x)
    y = function(x)
    dr.forward_from(x)
    return dr.detach(y), dr.grad(y)
