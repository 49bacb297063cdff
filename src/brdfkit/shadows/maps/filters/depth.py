"""The simplest filter: a point is dark if its texel holds a depth nearer to the light.

    lit = [z ≤ f(u, v)]

z is the depth of the point and f the depth in the texel (u, v) that it falls on; lit is 1 where the
comparison holds, else 0. The border of a shadow runs in steps, along the edges of texels.

[Williams 1978], [Ergun 2008, 2.2.1.2]
"""

from brdfkit.core.array_types import JitFloat, MitsubaObject
from brdfkit.shadows.maps.map_point import MapPoint
from brdfkit.shadows.maps.texels import Texels


class Lookup:
    """A shadow map that compares a point's depth with that of the single texel it falls on."""

    def __init__(self, depths: MitsubaObject) -> None:
        self.texels = Texels(depths)

    def visibility(self, point: MapPoint) -> JitFloat:
        """Return the share of the light that arrives at a point: 0 or 1."""
        return self.texels.visibility(point, point.u, point.v)
