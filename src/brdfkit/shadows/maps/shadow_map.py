"""One shadow map of one light: a projection, the depths seen through it, and how they are read."""

from brdfkit.shadows.maps.bias import AUTOMATIC
from brdfkit.shadows.maps.depth_pass import depth_pass
from brdfkit.shadows.maps.map_point import map_point


class ShadowMap:
    """What a light sees of a scene, to be looked up.

    scene : a `mi.Scene`.
    projection : a `Projection` through the light.
    reach : of the light through the scene [unit of length].
    lookup : of a file of `filters/`, its class `Lookup`.
    resolution : texels along a side.
    bias : a `Bias`.
    see : of that file, its function `see` where it has one: what the map holds in place of depths.
    """

    def __init__(
        self, scene, projection, reach, lookup, resolution=1024, bias=AUTOMATIC, see=depth_pass
    ):
        self.depths = see(scene, projection, resolution)
        self.lookup = lookup(self.depths)
        self.projection = projection.opaque()
        self.resolution, self.bias, self.reach = resolution, bias, reach

    def lit(self, p, n, active=True):
        """The share of the light that arrives at points `p` of surfaces with normals `n`."""
        point = map_point(self.projection, self.resolution, p, n, self.bias, self.reach, active)
        return self.lookup.lit(point)
