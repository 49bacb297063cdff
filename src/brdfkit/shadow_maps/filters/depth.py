"""One look-up: a point is dark where the map saw something nearer to the light.

[Williams 1978], [Ergun 2008, 2.2.1.2]
"""

import drjit as dr

from brdfkit.shadow_maps.texels import Texels


class Lookup:
    """A map as it is, texel by texel."""

    def __init__(self, depths):
        self.texels = Texels(depths)

    def lit(self, point):
        """The share of the light that arrives at a `MapPoint`: 0 or 1."""
        import mitsuba as mi

        u, v = dr.floor(point.u), dr.floor(point.v)
        nearest = self.texels.at(mi.Int32(u), mi.Int32(v), point.active)
        return dr.select(point.depth_at(u + 0.5, v + 0.5) > nearest, mi.Float(0), 1)
