"""Percentage-closer filter (PCF): the share of n × n texels that leave the point lit.

    lit = 1/n² Σ_ij [z ≤ f_ij]

lit is the share of the light that arrives, z the depth of the point and f_ij the depth in a texel
of the window around it. The comparisons [z ≤ f_ij], 1 or 0, are averaged instead of the depths, as
an average of depths is no depth of a surface. The borders of shadows are n texels wide and have n²
steps, however far the occluder is from the receiver. Between the steps the light is constant, so
its derivative with respect to the scene is 0.

[Reeves et al. 1987], [Ergun 2008, 2.2.1.3]
"""

from brdfkit.core.array_types import JitFloat, MitsubaObject
from brdfkit.shadows.maps.map_point import MapPoint
from brdfkit.shadows.maps.texels import WIDTH, Windows

SETTINGS = {"width": WIDTH}


class Lookup:
    """A shadow map that averages depth comparisons over a window of `width` × `width` texels."""

    def __init__(self, depths: MitsubaObject, width: int) -> None:
        self.windows, self.width = Windows(depths, width), width

    def visibility(self, point: MapPoint) -> JitFloat:
        """Return the share of the light that arrives at a point."""
        equal = [1 / self.width] * self.width
        return self.windows.visibility(point, lambda begin: equal)
