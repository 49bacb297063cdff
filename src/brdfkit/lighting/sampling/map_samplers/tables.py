"""Samples a map by its cumulative sums: a row by binary search, then a cell of the row."""

import numpy as np

from brdfkit.lighting.sampling.power_map import cell_power, pixel_power
from brdfkit.mitsuba_bridge.arrays import cell


class Mip:
    """Mitsuba's `Hierarchical2D0` of the power of pixels, bilinear between them."""

    def __init__(self, brightness):
        import mitsuba as mi

        power = pixel_power(brightness)
        power = np.append(power, power[:, :1], axis=1).astype(np.float32)
        self.rows, self.columns = power.shape[0] - 1, power.shape[1] - 1
        self.warp = mi.Hierarchical2D0(power)
        self.nbytes = 4 * round(power.size * 7 / 3)  # the map, and a pyramid of sums over it

    def sample(self, u, active):
        point, density = self.warp.sample(u, active=active)
        return point.x * self.columns, point.y * self.rows, density

    def density(self, x, y, active):
        import mitsuba as mi

        at = mi.Point2f(x / self.columns, y / self.rows)
        return self.warp.eval(at, active=active)


class Cdf:
    """Mitsuba's `DiscreteDistribution2D` of the power of cells."""

    def __init__(self, brightness):
        import mitsuba as mi

        power = cell_power(brightness).astype(np.float32)
        self.rows, self.columns = power.shape
        self.table = mi.DiscreteDistribution2D(power)
        self.nbytes = 4 * (power.size + self.rows)  # sums of every row, and of all rows

    def sample(self, u, active):
        import mitsuba as mi

        corner, probability, rest = self.table.sample(u, active)
        point = mi.Point2f(corner) + rest
        return point.x, point.y, probability * (self.rows * self.columns)

    def density(self, x, y, active):
        import mitsuba as mi

        at = mi.Point2u(cell(x, self.columns), cell(y, self.rows))
        return self.table.pdf(at, active) * (self.rows * self.columns)
