"""Distances sampled on a regular grid and interpolated linearly along each axis."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.array_types import FloatArray, IntArray, JitFloat, JitInt, JitVector
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit.padding import pad
from brdfkit.distance_fields.boxes import Box, to_floats
from brdfkit.distance_fields.functions import (
    Point,
    clip,
    floor,
    length,
    lerp,
    maximum,
    minimum,
    read_grid_value,
    to_int,
)
from brdfkit.distance_fields.node import Node
from brdfkit.distance_fields.parameters import vector


def _check_values(what: str, values: Any, rules: Mapping[str, Any]) -> Any:
    """Return the values of a grid as an array (z, y, x); a Dr.Jit tensor stays as it is.

    what : name of the parameter, for the error message.
    """
    if not dr.is_tensor_v(values):
        try:
            values = np.asarray(values, float)
        except ValueError:
            raise BrdfkitError(f"{what} should be numbers, in rows of one length.") from None
        if not np.isfinite(values).all():
            at = np.argwhere(~np.isfinite(values))[0].tolist()
            raise BrdfkitError(f"{what} is not finite at (z, y, x) = {at}; check the values.")
    shape = tuple(values.shape)
    if len(shape) != 3 or min(shape) < 2:
        raise BrdfkitError(f"{what} has the shape {shape}; it should be (z, y, x), from 2 on.")
    return values


@dataclass(frozen=True, eq=False, repr=False)
class grid(Node):
    """A field given by values at the corners of the cells of a box, as in Mitsuba's `sdfgrid`.

    Outside of the box the field is √(e² + f²), or e + f where f < 0, with the distance e to the box
    and the value f at the nearest point of the box.

    Parameters
    ----------
    values : array (z, y, x), or a Dr.Jit tensor
        The values f; the first and the last along each axis lie on the faces of the box.
    low, high : three numbers, default 0 and 1
        The corners of the box.
    """

    values: Any = field(metadata={"check": _check_values})
    low: Any = vector((0.0, 0.0, 0.0))
    high: Any = vector((1.0, 1.0, 1.0))
    _cache: dict[Any, Any] = field(default_factory=dict, init=False)

    def __post_init__(self) -> None:
        super().__post_init__()
        if not (to_floats(self.low) < to_floats(self.high)).all():
            raise BrdfkitError(f"grid: low = {self.low} should be below high = {self.high}.")

    @property
    def counts(self) -> IntArray:
        """The number of values (3,) along x, y and z."""
        return np.array(self.values.shape[::-1])

    @property
    def spacing(self) -> FloatArray:
        """The edge lengths (3,) of a cell."""
        spacing: FloatArray = (to_floats(self.high) - to_floats(self.low)) / (self.counts - 1)
        return spacing

    @property
    def half_diagonal(self) -> float:
        """Half of the diagonal of a cell, which bounds the error of sampling.

        A grid of samples of a field with the bound L differs from that field by at most L times
        this length. For that is the most that a point is away from the corners of its cell, in the
        mean by the weights of interpolation.
        """
        return float(np.linalg.norm(self.spacing) / 2)

    @property
    def lipschitz(self) -> float:
        """An upper bound on the slope of the field, from its steepest cell."""
        if "lipschitz" not in self._cache:
            values = np.asarray(dr.detach(self.values), float)
            self._cache["lipschitz"] = _compute_largest_slope(values, self.spacing)
        bound: float = self._cache["lipschitz"]
        return bound

    def distance(self, p: JitVector) -> JitFloat:
        cell, shares, beyond = [], [], []
        for x, low, high, n in zip((p.x, p.y, p.z), self.low, self.high, self.counts, strict=True):
            nearest = minimum(maximum(x, low), high)
            beyond.append(x - nearest)
            cells = float(n - 1)
            u = (nearest - low) * (cells / (high - low))
            first = clip(floor(u), 0.0, cells - 1)
            cell.append(to_int(first))
            shares.append(u - first)
        f, e = self._interpolate(cell, Point(*shares)), length(*beyond)
        return length(e, maximum(f, 0.0)) + minimum(f, 0.0)

    def _interpolate(self, cell: Sequence[JitInt], shares: Point) -> JitFloat:
        """Return the value within the cell (i, j, k), at the `shares`, 0 to 1, of its edges."""
        i, j, k = cell
        dtype = type(shares.x)
        planes = []
        for c in (k, k + 1):
            rows = []
            for b in (j, j + 1):
                first, second = (read_grid_value(self, a, b, c, dtype) for a in (i, i + 1))
                rows.append(lerp(first, second, shares.x))
            planes.append(lerp(rows[0], rows[1], shares.y))
        return lerp(planes[0], planes[1], shares.z)

    def to_flat_array(self, dtype: type) -> Any:
        """Return all values in a row, x fastest, as a Dr.Jit array `dtype`; NumPy's for float."""
        if dr.is_tensor_v(self.values):
            return np.ravel(self.values) if dtype is float else dtype(self.values.array)
        if dtype not in self._cache:
            flat = self.values.ravel()
            self._cache[dtype] = flat if dtype is float else dtype(pad(flat))
        return self._cache[dtype]

    def bounds(self, level: float = 0.0) -> Box:
        return to_floats(self.low) - max(level, 0.0), to_floats(self.high) + max(level, 0.0)


def _compute_largest_slope(values: FloatArray, spacing: FloatArray) -> float:
    """Return the largest slope that the interpolation may have, in the steepest cell.

    Along an axis the slope within a cell is a mean of the slopes of its four edges. If the box cuts
    the solid, the field outside is the distance to the box plus a value on it, so that a slope L
    becomes √(1 + L²).
    """
    squared: Any = 0.0
    for axis, step in zip((2, 1, 0), spacing, strict=True):
        slope = np.abs(np.diff(values, axis=axis)) / step
        for other in {0, 1, 2} - {axis}:
            a, b = (np.take(slope, range(s, slope.shape[other] - 1 + s), other) for s in (0, 1))
            slope = np.maximum(a, b)
        squared = squared + slope**2
    steepest = float(np.sqrt(squared.max()))
    faces = [np.take(values, (0, -1), axis) for axis in range(3)]
    is_cut = min(face.min() for face in faces) < 0
    return float(np.hypot(1, steepest)) if is_cut else max(1.0, steepest)
