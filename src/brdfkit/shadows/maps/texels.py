"""Compares receivers with single texels of a shadow map, or with square windows of texels.

Each texel's depth is compared with the receiver's first, and the results are averaged; the depths
themselves are never averaged or interpolated.
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
        """Return the depth in a texel, or infinity beyond the map; indices are `mi.Int32`."""
        import mitsuba as mi

        size = dr.opaque(mi.Int32, self.resolution)
        within = active & (column >= 0) & (column < size) & (row >= 0) & (row < size)
        value = dr.gather(mi.Float, self.values, mi.UInt32(row * size + column), within)
        return dr.select(within, value, dr.inf)

    def read_depths(self, point: MapPoint, u: JitFloat, v: JitFloat) -> tuple[JitFloat, JitFloat]:
        """Return the depths of the texel at (u, v) and of the receiver's tangent plane there."""
        import mitsuba as mi

        u, v = dr.floor(u), dr.floor(v)
        plane_depth = point.plane_depth(u + 0.5, v + 0.5)
        return self.read_texel(mi.Int32(u), mi.Int32(v), point.active), plane_depth

    def visibility(self, point: MapPoint, u: JitFloat, v: JitFloat) -> JitFloat:
        """Return 1 if the texel at (u, v) leaves a receiver lit, or 0 if its depth is nearer."""
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
        """Return the share of light, the weighted mean of comparisons with a window's texels.

        It is Σ_ij w_i w_j [z_ij ≤ f_ij], where f_ij is the depth in a texel, z_ij the depth of the
        receiver's tangent plane there, and [...] 1 or 0.

        weights : function that returns the weights w of the columns (or rows) of the window. Its
            argument is the place within the first texel where the window begins, 0 to 1.
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
