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
    """Vectors in a model's formula: x, y and z are arrays (n,) in double precision."""

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
    """Return the array type for models: `Float64` of LLVM or CUDA, or without them `ArrayXf64`."""
    if llvm.find_loaded_version() >= llvm.OLDEST:
        return dr.llvm.ad.Float64
    if dr.has_backend(dr.JitBackend.CUDA):
        return dr.cuda.ad.Float64
    return dr.scalar.ArrayXf64


def has_derivatives() -> bool:
    """Return whether Dr.Jit's arrays for models have derivatives."""
    return bool(dr.is_diff_v(choose_float_type()))


def to_array(values: ArrayLike) -> JitFloat:
    """Convert a NumPy array (n,) to Dr.Jit's array type for models."""
    return choose_float_type()(pad(np.asarray(values, float)))


def to_vector(w: FloatArray) -> Vector:
    """Convert NumPy directions (n, 3) to a `Vector`."""
    return Vector(*(to_array(w[:, k]) for k in range(3)))


def to_scalar(value: float) -> JitFloat:
    """Convert a number to an array of size 1; kernels do not depend on its value (it is opaque)."""
    number = choose_float_type()(float(value))
    dr.make_opaque(number)
    return number


def differentiate(
    function: Callable[[JitFloat], JitFloat], x: JitFloat
) -> tuple[JitFloat, JitFloat]:
    """Return the value and the derivative of a `function` at the array `x`."""
    if not has_derivatives():
        h = 1e-6 * dr.maximum(x, 1e-3)
        return function(x), (function(x + h) - function(x - h)) / (2 * h)
    dr.enable_grad(x)
    y = function(x)
    dr.forward_from(x)
    return dr.detach(y), dr.grad(y)
