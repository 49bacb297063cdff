"""Percentage-closer filter (PCF): the share of n × n texels that leave the point lit.

    lit = 1/n² Σ_ij [z ≤ f_ij]

z is the depth of the point, f_ij the depth in a texel. Depths are compared first and averaged then,
as an average of depths is no depth of a surface. The borders of shadows are n texels wide, in n²
steps, whatever the distance between the objects; the derivative by their place is 0 between the
steps.

[Reeves et al. 1987], [Ergun 2008, 2.2.1.3]
"""

from brdfkit.core.array_types import JitFloat, MitsubaObject
from brdfkit.shadows.maps.map_point import MapPoint
from brdfkit.shadows.maps.texels import WIDTH, Windows

SETTINGS = {"width": WIDTH}


class Lookup:
    """The mean of comparisons over a window of texels, `width` along a side."""

    def __init__(self, depths: MitsubaObject, width: int) -> None:
        self.windows, self.width = Windows(depths, width), width

    def lit_share(self, point: MapPoint) -> JitFloat:
        """Return the share of the light that arrives at a point."""
        equal = [1 / self.width] * self.width
        return self.windows.lit_share(point, lambda begin: equal)
