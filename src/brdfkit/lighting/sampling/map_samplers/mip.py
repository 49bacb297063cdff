"""Samples a map by descending its mip levels, as Mitsuba's `envmap` does: the exact density."""

import numpy as np

from brdfkit.lighting.sampling.power_map import pixel_power


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
