"""Square windows of texels about a point, for filters that compare first and average then."""

import drjit as dr

from brdfkit.mitsuba_bridge.properties.declarations import count

WIDTH = count(3, (1, 15), "texels along a side of the window")


class Windows:
    """The windows of a map, framed by infinity so wide that none reaches beyond the frame.

    values : a `mi.TensorXf` (resolution, resolution).
    width : texels along a side of a window.
    """

    def __init__(self, values, width):
        self.width, self.resolution = width, values.shape[0]
        self.values = framed(values, width).array

    def mean_lit(self, point, weights):
        """The mean of what the texels of a window say of a `MapPoint`: Σ_ij w_i w_j [z ≤ f_ij].

        weights : of the columns and rows; a function of where, from 0 to 1, the window begins
            within its first texel.
        """
        import mitsuba as mi

        n, half = self.width, (self.width - 1) / 2
        u, v = dr.floor(point.u - half), dr.floor(point.v - half)
        size = dr.opaque(mi.Int32, self.resolution)
        column, row = (dr.clip(mi.Int32(begin), -n, size) + n for begin in (u, v))
        first, row_length = mi.UInt32(row * (size + 2 * n) + column), mi.UInt32(size + 2 * n)
        across, upwards = weights(point.u - half - u), weights(point.v - half - v)

        def lit(i, j):
            seen = dr.gather(mi.Float, self.values, first + (j * row_length + i))
            return dr.select(point.depth_at(u + i + 0.5, v + j + 0.5) > seen, mi.Float(0), 1)

        rows = (upwards[j] * sum(across[i] * lit(i, j) for i in range(n)) for j in range(n))
        return dr.select(point.active, sum(rows), 1)


def framed(values, width):
    """A square tensor with a frame of infinity, `width` values wide."""
    for axis in (0, 1):
        shape = [width, values.shape[1]] if axis == 0 else [values.shape[0], width]
        edge = dr.full(type(values), dr.inf, shape)
        values = dr.concat([edge, values, edge], axis)
    return values
