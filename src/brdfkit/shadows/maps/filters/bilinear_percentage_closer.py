"""Bilinear percentage-closer filter: a percentage-closer window that moves with the point.

    lit = Σ_ij w_i w_j [z ≤ f_ij],   w = (1 - s, 1 ... 1, s) / (n - 1)

z is the depth of the point, f_ij the depth in a texel of the n × n window, and s, from 0 to 1,
where the window begins within its first texel. With n = 3 texels, w = ((1 - s)/2, 1/2, s/2): the
mean of the four bilinear interpolations of [Ergun 2008, 2.2.1.3], which graphics hardware makes of
the comparisons of 2 × 2 texels. The borders of shadows are n - 1 texels wide, and smooth.

[Reeves et al. 1987], [Ergun 2008, 2.2.1.3]
"""

from brdfkit.core.array_types import JitFloat, MitsubaObject
from brdfkit.shadows.maps.map_point import MapPoint
from brdfkit.shadows.maps.texels import WIDTH, Windows

SETTINGS = {"width": WIDTH}


class Lookup:
    """A shadow map that averages depth comparisons over a window that moves with the point.

    The sides of the window are `width` - 1 texels long. A `width` of 1 compares a single texel.
    """

    def __init__(self, depths: MitsubaObject, width: int) -> None:
        self.windows, self.width = Windows(depths, width), width

    def visibility(self, point: MapPoint) -> JitFloat:
        """Return the share of the light that arrives at a point."""
        return self.windows.visibility(point, self.window_weights)

    def window_weights(self, begin: JitFloat) -> list[JitFloat]:
        """Return the weights of a window's columns or rows, which add up to 1.

        begin : where the window begins within its first texel, 0 to 1.
        """
        if self.width == 1:
            return [1.0]
        inner = [1.0] * (self.width - 2)
        return [w / (self.width - 1) for w in (1 - begin, *inner, begin)]
