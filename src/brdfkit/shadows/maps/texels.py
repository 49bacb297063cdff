"""The depths of a map by whole texels: looked up one by one, never blended."""

import drjit as dr


class Texels:
    """The values of a square map; beyond its edge is infinity: nothing is in front.

    values : a `mi.TensorXf` (resolution, resolution).
    """

    def __init__(self, values):
        self.resolution = values.shape[0]
        self.values = values.array

    def at(self, column, row, active=True):
        """The values at whole texels, `mi.Int32`."""
        import mitsuba as mi

        size = dr.opaque(mi.Int32, self.resolution)
        within = active & (column >= 0) & (column < size) & (row >= 0) & (row < size)
        found = dr.gather(mi.Float, self.values, mi.UInt32(row * size + column), within)
        return dr.select(within, found, dr.inf)

    def depth_under(self, point, u, v):
        """The value at a place of the map, and the depth that the plane of a `MapPoint` has in the
        middle of that texel."""
        import mitsuba as mi

        u, v = dr.floor(u), dr.floor(v)
        there = point.depth_at(u + 0.5, v + 0.5)
        return self.at(mi.Int32(u), mi.Int32(v), point.active), there

    def lit(self, point, u, v):
        """1 where the texel at a place of the map leaves a `MapPoint` lit, 0 where it saw
        something nearer."""
        import mitsuba as mi

        seen, depth = self.depth_under(point, u, v)
        return dr.select(depth > seen, mi.Float(0), 1)
