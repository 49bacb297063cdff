"""Comparison of receivers with single texels of a shadow map, or with square windows of texels.

Depths are never interpolated: filters compare each texel's depth with the receiver's first, and
average the results.
"""

from collections.abc import Callable
from typing import Any

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitInt, JitMask, MitsubaObject
from brdfkit.mitsuba_bridge.properties.declarations import declare_int
from brdfkit.shadows.maps.map_point import MapPoint

WIDTH = declare_int(3, (1, 15), "texels along a side of the window")


class Texels:
    """The texels of a square shadow map, with infinite depths beyond its edge, where all is lit.

    values : depths, a `mi.TensorXf` (resolution, resolution).
    """

    def __init__(self, values: MitsubaObject) -> None:
        self.resolution = values.shape[0]
        self.values = values.array

    def read_texel(self, column: JitInt, row: JitInt, active: JitMask = True) -> JitFloat:
        """Return the depths of texels by `mi.Int32` column and row; infinity beyond the map."""
        import mitsuba as mi

        size = dr.opaque(mi.Int32, self.resolution)
        within = active & (column >= 0) & (column < size) & (row >= 0) & (row < size)
        value = dr.gather(mi.Float, self.values, mi.UInt32(row * size + column), within)
        return dr.select(within, value, dr.inf)

    def read_depths(self, point: MapPoint, u: JitFloat, v: JitFloat) -> tuple[JitFloat, JitFloat]:
        """Return the depth in the texel at (u, v), and the depth of the receiver's plane there."""
        import mitsuba as mi

        u, v = dr.floor(u), dr.floor(v)
        plane_depth = point.plane_depth(u + 0.5, v + 0.5)
        return self.read_texel(mi.Int32(u), mi.Int32(v), point.active), plane_depth

    def visibility(self, point: MapPoint, u: JitFloat, v: JitFloat) -> JitFloat:
        """Return 1 where the texel at (u, v) leaves a receiver lit, 0 where it is nearer."""
        import mitsuba as mi

        occluder, depth = self.read_depths(point, u, v)
        return dr.select(depth > occluder, mi.Float(0), 1)


class Windows:
    """Square windows of texels around receivers, for the filters that average comparisons.

    A frame of infinity, as wide as a window, surrounds the map, so that all is lit beyond its edge.

    values : depths, a `mi.TensorXf` (resolution, resolution).
    width : number of texels along a side of a window.
    """

    def __init__(self, values: MitsubaObject, width: int) -> None:
        self.width, self.resolution = width, values.shape[0]
        self.values = add_infinite_frame(values, width).array

    def visibility(self, point: MapPoint, weights: Callable[[Any], Any]) -> JitFloat:
        """Return the weighted mean of comparisons with a window's texels: Σ_ij w_i w_j [z ≤ f_ij].

        z is the depth of the receiver's plane and f_ij that in a texel.

        weights : function that returns the weights w of the columns or rows, given where the window
            begins within its first texel, 0 to 1.
        """
        import mitsuba as mi

        n, half = self.width, (self.width - 1) / 2
        u, v = dr.floor(point.u - half), dr.floor(point.v - half)
        size = dr.opaque(mi.Int32, self.resolution)
        column, row = (dr.clip(mi.Int32(begin), -n, size) + n for begin in (u, v))
        first, row_length = mi.UInt32(row * (size + 2 * n) + column), mi.UInt32(size + 2 * n)
        across, upwards = weights(point.u - half - u), weights(point.v - half - v)

        def compare_texel(i: int, j: int) -> JitFloat:
            occluder = dr.gather(mi.Float, self.values, first + (j * row_length + i))
            depth = point.plane_depth(u + i + 0.5, v + j + 0.5)
            return dr.select(depth > occluder, mi.Float(0), 1)

        rows = (
            upwards[j] * sum(across[i] * compare_texel(i, j) for i in range(n)) for j in range(n)
        )
        return dr.select(point.active, sum(rows), 1)


def add_infinite_frame(values: MitsubaObject, width: int) -> MitsubaObject:
    """Return a square tensor with a frame of infinity, `width` values wide."""
    for axis in (0, 1):
        shape = [width, values.shape[1]] if axis == 0 else [values.shape[0], width]
        edge = dr.full(type(values), dr.inf, shape)
        values = dr.concat([edge, values, edge], axis)
    return values
