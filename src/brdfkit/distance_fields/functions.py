"""The functions in which the formulas of distance fields are written.

A formula is written once, with these functions and with + - * / and <. On Dr.Jit arrays and plain
numbers it computes the distance; on the symbols of `symbols.py` it writes the formula as GLSL.
"""

from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

import drjit as dr
import numpy as np

from brdfkit.core.array_types import ArrayLike, FloatArray, JitFloat, JitInt, JitMask, JitVector
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit import double_precision
from brdfkit.core.jit.threads import in_turn
from brdfkit.distance_fields.symbols import Symbol


@in_turn
def evaluate(distance: Callable[[JitVector], JitFloat], points: ArrayLike) -> FloatArray:
    """Return the values (n,) of a distance function at `points` (n, 3), in double precision."""
    points = np.asarray(points, dtype=float)
    if points.ndim != 2 or points.shape[1] != 3:
        raise BrdfkitError(f"points have the shape {points.shape}; it should be (n, 3).")
    if not len(points):
        return np.zeros(0)
    values = np.asarray(distance(double_precision.to_vector(points)), float)
    return np.broadcast_to(values, len(points)).copy()


class Point(NamedTuple):
    """A point or a vector, whose components are Dr.Jit arrays, numbers or symbols."""

    x: Any
    y: Any
    z: Any


def _make_drjit_or_glsl_function(glsl: str, drjit: Callable[..., Any]) -> Callable[..., Any]:
    """Return a function that calls `drjit`, or for symbols adds a call of `glsl` to their program.

    drjit : a function of Dr.Jit arrays and numbers.
    glsl : the name of the same function in GLSL.
    """

    def call_or_record(*args: Any) -> Any:
        symbol = next((a for a in args if isinstance(a, Symbol)), None)
        return drjit(*args) if symbol is None else symbol.program.add_call(glsl, *args)

    return call_or_record


def _sqrt(a: JitFloat) -> JitFloat:
    """Return √a with the derivative 0 at a = 0; `dr.safe_sqrt` has a wrong one there and near 0."""
    zero = a <= 0  # this is false for NaN, which stays NaN
    return dr.select(zero, 0.0, dr.sqrt(dr.select(zero, 1.0, a)))


sqrt = _make_drjit_or_glsl_function("sqrt", _sqrt)
absolute = _make_drjit_or_glsl_function("abs", dr.abs)
minimum = _make_drjit_or_glsl_function("min", dr.minimum)
maximum = _make_drjit_or_glsl_function("max", dr.maximum)
clip = _make_drjit_or_glsl_function("clamp", dr.clip)
floor = _make_drjit_or_glsl_function("floor", dr.floor)
sin = _make_drjit_or_glsl_function("sin", dr.sin)
cos = _make_drjit_or_glsl_function("cos", dr.cos)
acos = _make_drjit_or_glsl_function("acos", dr.safe_acos)
atan2 = _make_drjit_or_glsl_function("atan", dr.atan2)
log = _make_drjit_or_glsl_function("log", dr.log)
power = _make_drjit_or_glsl_function("pow", dr.power)


def select(condition: JitMask, a: JitFloat, b: JitFloat) -> JitFloat:
    """Return `a` where the condition holds, and `b` elsewhere."""
    if isinstance(condition, Symbol):
        return condition.program.add_selection(condition, a, b)
    return dr.select(condition, a, b)


def to_int(a: JitFloat) -> JitInt:
    """Return a number without its fractional part, as an integer."""
    if isinstance(a, Symbol):
        return a.to_int()
    return int(a) if isinstance(a, float) else dr.int32_array_t(type(a))(a)


def read_grid_value(grid: Any, i: JitInt, j: JitInt, k: JitInt, dtype: type) -> JitFloat:
    """Return the value of a `grid` at the indices i, j, k along x, y, z, as an array of `dtype`."""
    if isinstance(i, Symbol):
        return i.program.read_grid_value(grid, i, j, k)
    columns, rows = (int(n) for n in grid.counts[:2])
    index = i + columns * (j + rows * k)
    if isinstance(i, int):
        return float(grid.to_flat_array(float)[index])
    return dr.gather(dtype, grid.to_flat_array(dtype), dr.uint32_array_t(type(i))(index))


def lerp(a: JitFloat, b: JitFloat, t: JitFloat) -> JitFloat:
    """Return the linear interpolation between `a` at t = 0 and `b` at t = 1."""
    return a + t * (b - a)


def length(*components: JitFloat) -> JitFloat:
    """Return the length √(x² + y² + ...) of a vector."""
    return sqrt(sum((c * c for c in components[1:]), components[0] * components[0]))


def dot(a: Iterable[JitFloat], b: Iterable[JitFloat]) -> JitFloat:
    """Return the dot product of two triples."""
    (ax, ay, az), (bx, by, bz) = a, b
    return ax * bx + ay * by + az * bz


def subtract(p: JitVector, q: Iterable[JitFloat]) -> Point:
    """Return `p` - `q` as a `Point`; p has the attributes x, y and z, and q is a triple."""
    x, y, z = q
    return Point(p.x - x, p.y - y, p.z - z)


def normalize(v: Iterable[JitFloat]) -> Point:
    """Return the unit vector along `v`, a triple of numbers or arrays."""
    x, y, z = v
    size = dr.sqrt(x * x + y * y + z * z)
    return Point(x / size, y / size, z / size)
