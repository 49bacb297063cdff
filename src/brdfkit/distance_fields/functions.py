"""The functions of which distances are made: on Dr.Jit's arrays, on numbers, and on GLSL's names.

A formula is written once, with these and with + - * / and <. Given arrays it computes; given the
`Symbol`s of `export/glsl.py` it writes the same formula as GLSL.
"""

from typing import Any, NamedTuple

import drjit as dr
import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit import double_precision
from brdfkit.core.jit.threads import in_turn
from brdfkit.distance_fields.symbols import Symbol


@in_turn
def evaluate(distance, points):
    """f (n,) of a callable `distance` at `points` (n, 3)."""
    points = np.asarray(points, float)
    if points.ndim != 2 or points.shape[1] != 3:
        raise BrdfkitError(f"points have the shape {points.shape}; it should be (n, 3).")
    if not len(points):
        return np.zeros(0)
    values = np.asarray(distance(double_precision.vector(points)), float)
    return np.broadcast_to(values, len(points)).copy()


class Point(NamedTuple):
    """A point, or a vector: x, y and z are arrays, numbers or symbols."""

    x: Any
    y: Any
    z: Any


def _function(glsl, drjit):
    """The function that is called `glsl` in GLSL, and `drjit` on all else."""

    def call(*args):
        symbol = next((a for a in args if isinstance(a, Symbol)), None)
        return drjit(*args) if symbol is None else symbol.program.call(glsl, *args)

    return call


def _root(a):
    """√a with the derivative 0 at a = 0; `dr.safe_sqrt` has a wrong one close to it, too."""
    nothing = a <= 0  # false of NaN, which stays
    return dr.select(nothing, 0.0, dr.sqrt(dr.select(nothing, 1.0, a)))


sqrt = _function("sqrt", _root)
absolute = _function("abs", dr.abs)
minimum = _function("min", dr.minimum)
maximum = _function("max", dr.maximum)
clip = _function("clamp", dr.clip)
floor = _function("floor", dr.floor)
sin = _function("sin", dr.sin)
cos = _function("cos", dr.cos)
acos = _function("acos", dr.safe_acos)
atan2 = _function("atan", dr.atan2)
log = _function("log", dr.log)
power = _function("pow", dr.power)


def select(condition, a, b):
    """`a` where the condition holds, else `b`."""
    if isinstance(condition, Symbol):
        return condition.program.select(condition, a, b)
    return dr.select(condition, a, b)


def to_int(a):
    """A number as a whole number, cut."""
    if isinstance(a, Symbol):
        return a.to_int()
    return int(a) if isinstance(a, float) else dr.int32_array_t(type(a))(a)


def texel(grid, i, j, k, kind):
    """The value (i, j, k) along x, y, z of a `grid`, as an array of this kind."""
    if isinstance(i, Symbol):
        return i.program.texel(grid, i, j, k)
    across, down = (int(n) for n in grid.counts[:2])
    index = i + across * (j + down * k)
    if isinstance(i, int):
        return float(grid.array(float)[index])
    return dr.gather(kind, grid.array(kind), dr.uint32_array_t(type(i))(index))


def lerp(a, b, t):
    """From `a` at t = 0 to `b` at t = 1."""
    return a + t * (b - a)


def length(*components):
    """√(x² + y² + ...)."""
    return sqrt(sum((c * c for c in components[1:]), components[0] * components[0]))


def dot(a, b):
    """The dot product of two triples."""
    (ax, ay, az), (bx, by, bz) = a, b
    return ax * bx + ay * by + az * bz


def minus(p, q):
    """`p` - `q`, of anything with x, y, z and a triple."""
    x, y, z = q
    return Point(p.x - x, p.y - y, p.z - z)


def normalized(v):
    """The triple `v`, of numbers or arrays, as a unit vector."""
    x, y, z = v
    size = dr.sqrt(x * x + y * y + z * z)
    return Point(x / size, y / size, z / size)
