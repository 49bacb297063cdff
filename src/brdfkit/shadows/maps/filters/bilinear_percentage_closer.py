"""Bilinear percentage-closer filter: a percentage-closer window that moves with the point.

    lit = Σ_ij w_i w_j [z ≤ f_ij],   w = (1 - s, 1 ... 1, s) / (n - 1)

lit is the share of the light that arrives, z the depth of the point and f_ij the depth in a texel
of the n × n window. [...] is 1 where the comparison holds, else 0. The weights w of the columns and
rows depend on s, from 0 to 1: the place within the first texel where the window begins. So the
borders of shadows are smooth, and n - 1 texels wide.

With n = 3, w = ((1 - s)/2, 1/2, s/2). This is the mean of the four bilinear interpolations of
[Ergun 2008, 2.2.1.3], each of which graphics hardware makes of comparisons with 2 × 2 texels.

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
        """Return the weights of a window's columns (or rows), which add up to 1.

        begin : the place within the first texel where the window begins, from 0 to 1.
        """
        if self.width == 1:
            return [1.0]
        inner = [1.0] * (self.width - 2)
        return [w / (self.width - 1) for w in (1 - begin, *inner, begin)]
