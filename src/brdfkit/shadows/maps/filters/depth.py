"""One look-up: a point is dark where the map saw something nearer to the light.

    lit = [z ≤ f(u, v)]

The border of a shadow runs along the edges of texels, in steps.

[Williams 1978], [Ergun 2008, 2.2.1.2]
"""

from brdfkit.shadows.maps.texels import Texels


class Lookup:
    """A map as it is, texel by texel."""

    def __init__(self, depths):
        self.texels = Texels(depths)

    def lit(self, point):
        """The share of the light that arrives at a `MapPoint`: 0 or 1."""
        return self.texels.lit(point, point.u, point.v)
