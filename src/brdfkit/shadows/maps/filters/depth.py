"""One look-up: a point is dark where the map holds a depth nearer to the light.

    lit = [z ≤ f(u, v)]

z is the depth of the point, f that in the map. The border of a shadow runs along the edges of
texels, in steps.

[Williams 1978], [Ergun 2008, 2.2.1.2]
"""

from brdfkit.core.array_types import JitFloat, MitsubaObject
from brdfkit.shadows.maps.map_point import MapPoint
from brdfkit.shadows.maps.texels import Texels


class Lookup:
    """The look-up of the single texel under a point."""

    def __init__(self, depths: MitsubaObject) -> None:
        self.texels = Texels(depths)

    def lit_share(self, point: MapPoint) -> JitFloat:
        """Return the share of the light that arrives at a point: 0 or 1."""
        return self.texels.lit_share(point, point.u, point.v)
