"""Percentage-closer soft shadows (PCSS): a percentage-closer filter as wide as the penumbra.

    w = w_light (d_r - d_b) / d_b

d_r is the receiver's distance from the light and d_b the mean one of the occluders that a search
finds, as if all of them were a plane there, parallel to the light. The search takes the cone from
the receiver to the light, up to the map's near side. Both look at taps on a spiral in a disk that
is round in the world, whatever the projection does to it. `light_size` makes a round light of the
point that the scene has; of one far away it is the tangent of its diameter, the sun's 0.0093.

Occluders behind others are not seen, and the mean over several depths is none of them: overlapping
penumbrae are wrong, and contacts a little too light.

[Fernando 2005]
"""

import math

import drjit as dr

from brdfkit.mitsuba_bridge.properties.declarations import count, plain_number
from brdfkit.shadows.maps.texels import Texels

SETTINGS = {
    "light_size": plain_number(0.01, (0.0, 1e9), "diameter of the light [unit], or its tangent"),
    "taps": count(32, (1, 256), "look-ups of the search, and as many of the filter"),
}


class Lookup:
    """A search for occluders, then the mean of comparisons over a disk."""

    def __init__(self, depths, light_size, taps):
        self.texels, self.light_size, self.taps = Texels(depths), light_size, spiral(taps)

    def lit(self, point):
        """The share of the light that arrives at a `MapPoint`."""
        return self.mean_lit(point, self.penumbra(point, self.mean_depth_of_occluders(point)))

    def mean_depth_of_occluders(self, point):
        """In the map's cube; the point's own where there are none."""
        import mitsuba as mi

        total, found = mi.Float(0), mi.Float(0)
        for u, v in self.places(point, self.penumbra(point, mi.Float(-1))):
            seen, depth = self.texels.depth_under(point, u, v)
            total += dr.select(seen < depth, dr.maximum(seen, -1), 0)
            found += dr.select(seen < depth, mi.Float(1), 0)
        return dr.select(found > 0, total / found, point.depth)

    def penumbra(self, point, depth):
        """w of occluders at a depth of the map's cube [unit of length]."""
        occluder, light = point.before(depth), point.projection.light
        gap = dr.norm(occluder - point.p)
        if not light.is_directional:
            gap = gap / dr.norm(occluder - type(occluder)(light.point.xyz))
        return self.light_size * gap

    def mean_lit(self, point, width):
        """The share of taps in a disk of this diameter that leave the point lit."""
        lit = sum(self.texels.lit(point, u, v) for u, v in self.places(point, width))
        return lit / len(self.taps)

    def places(self, point, width):
        """The taps on the map, in a disk about the point, across the light."""
        (u_s, v_s), (u_t, v_t) = point.across()
        for s, t in self.taps:
            x, y = s * width / 2, t * width / 2
            yield point.u + x * u_s + y * u_t, point.v + x * v_s + y * v_t


def spiral(n):
    """Points of the unit disk, evenly by area: turned by the golden angle from one to the next."""
    golden = math.pi * (3 - math.sqrt(5))
    return [
        (
            math.sqrt((i + 0.5) / n) * math.cos(i * golden),
            math.sqrt((i + 0.5) / n) * math.sin(i * golden),
        )
        for i in range(n)
    ]
