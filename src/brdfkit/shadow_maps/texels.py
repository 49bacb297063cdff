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
