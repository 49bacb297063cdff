"""Grids of values, interpolated linearly along each axis."""

from dataclasses import dataclass, field
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit.padding import pad
from brdfkit.distance_fields.boxes import plain
from brdfkit.distance_fields.functions import (
    Point,
    clip,
    floor,
    length,
    lerp,
    maximum,
    minimum,
    texel,
    to_int,
)
from brdfkit.distance_fields.node import Node
from brdfkit.distance_fields.parameters import vector


def _values(what, values, rules):
    """The values of a grid: an array of NumPy's, or a tensor of Dr.Jit's."""
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
    """Values at the corners of the cells of a box, as Mitsuba's `sdfgrid` has them.

    Outside of its box the distance is √(e² + f²), of the distance e to the box and the value f at
    the nearest point of it.

    Parameters
    ----------
    values : array (z, y, x), or a tensor of Dr.Jit's
        f; the first and the last along each axis lie on the faces of the box.
    low, high : three numbers, default 0 and 1
        The corners of the box.
    """

    values: Any = field(metadata={"check": _values})
    low: Any = vector((0.0, 0.0, 0.0))
    high: Any = vector((1.0, 1.0, 1.0))
    _arrays: dict = field(default_factory=dict, init=False)

    def __post_init__(self):
        super().__post_init__()
        if not (plain(self.low) < plain(self.high)).all():
            raise BrdfkitError(f"grid: low = {self.low} should be below high = {self.high}.")

    @property
    def counts(self) -> np.ndarray:
        """How many values there are along x, y and z."""
        return np.array(self.values.shape[::-1])

    @property
    def spacing(self) -> np.ndarray:
        """The edges (3,) of a cell."""
        return (plain(self.high) - plain(self.low)) / (self.counts - 1)

    @property
    def half_diagonal(self) -> float:
        """Half of the diagonal of a cell: values sampled of a field differ from it by L times this.

        A point is that far, or less, from the corners of its cell in the mean of their weights.
        """
        return float(np.linalg.norm(self.spacing) / 2)

    @property
    def lipschitz(self):
        if "lipschitz" not in self._arrays:
            values = np.asarray(dr.detach(self.values), float)
            self._arrays["lipschitz"] = _largest_slope(values, self.spacing)
        return self._arrays["lipschitz"]

    def distance(self, p):
        place, shares, beyond = [], [], []
        for x, low, high, n in zip((p.x, p.y, p.z), self.low, self.high, self.counts, strict=True):
            nearest = minimum(maximum(x, low), high)
            beyond.append(x - nearest)
            cells = float(n - 1)
            u = (nearest - low) * (cells / (high - low))
            cell = clip(floor(u), 0.0, cells - 1)
            place.append(to_int(cell))
            shares.append(u - cell)
        f, e = self._interpolated(place, Point(*shares)), length(*beyond)
        return length(e, maximum(f, 0.0)) + minimum(f, 0.0)

    def _interpolated(self, place, shares):
        """The value in the cell at `place`, at the `shares` of its edges."""
        i, j, k = place
        kind = type(shares.x)
        planes = []
        for c in (k, k + 1):
            rows = []
            for b in (j, j + 1):
                ends = texel(self, i, b, c, kind), texel(self, i + 1, b, c, kind)
                rows.append(lerp(*ends, shares.x))
            planes.append(lerp(*rows, shares.y))
        return lerp(*planes, shares.z)

    def array(self, kind):
        """All values in a row, as an array of Dr.Jit's `kind`, or NumPy's for `kind` float."""
        if dr.is_tensor_v(self.values):
            return np.ravel(self.values) if kind is float else kind(self.values.array)
        if kind not in self._arrays:
            flat = self.values.ravel()
            self._arrays[kind] = flat if kind is float else kind(pad(flat))
        return self._arrays[kind]

    def bounds(self, level=0.0):
        return plain(self.low) - max(level, 0.0), plain(self.high) + max(level, 0.0)


def _largest_slope(values, spacing):
    """The largest slope that the interpolation may have: that of the steepest cell.

    Along an axis the slope of a cell is a mean of those of its four edges. Where the box cuts the
    solid, the distance outside grows as e + f, by √(1 + L²).
    """
    squared = 0.0
    for axis, step in zip((2, 1, 0), spacing, strict=True):
        slope = np.abs(np.diff(values, axis=axis)) / step
        for other in {0, 1, 2} - {axis}:
            a, b = (np.take(slope, range(s, slope.shape[other] - 1 + s), other) for s in (0, 1))
            slope = np.maximum(a, b)
        squared = squared + slope**2
    steepest = float(np.sqrt(squared.max()))
    faces = [np.take(values, (0, -1), axis) for axis in range(3)]
    cut = min(face.min() for face in faces) < 0
    return float(np.hypot(1, steepest)) if cut else max(1.0, steepest)
