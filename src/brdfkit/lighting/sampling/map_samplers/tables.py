"""Samples a map by its cumulative sums: a row by binary search, then a cell of the row."""

import numpy as np

from brdfkit.lighting.sampling.power_map import cell_power
from brdfkit.mitsuba_bridge.arrays import cell


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
