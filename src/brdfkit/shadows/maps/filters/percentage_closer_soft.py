"""Percentage-closer soft shadows (PCSS): a percentage-closer filter as wide as the penumbra.

    w = w_light (d_r - d_b) / d_b

w is the width of the penumbra, w_light the width of the light, d_r the receiver's distance from the
light, and d_b the mean distance of the occluders, which are treated as a plane parallel to the
light. The setting `light_size` is w_light, which a point light of Mitsuba does not have; for a
directional light it is the tangent of its angular diameter, 0.0093 for the sun.

First a search finds the occluders: it reads texels within the cone from the receiver to the light.
Then the filter averages depth comparisons over a disk of the width w. Both read texels (taps) at
the points of a spiral that fills a disk in the world, at right angles to the light.

The map does not contain occluders behind others, and several occluders are replaced by one at their
mean depth. So overlapping penumbrae are wrong, and contact shadows a little too light.

[Fernando 2005]
"""

import math
from collections.abc import Iterator

import drjit as dr

from brdfkit.core.array_types import JitFloat, MitsubaObject
from brdfkit.mitsuba_bridge.properties.declarations import declare_float, declare_int
from brdfkit.shadows.maps.map_point import MapPoint
from brdfkit.shadows.maps.texels import Texels

SETTINGS = {
    "light_size": declare_float(0.01, (0.0, 1e9), "diameter of the light [unit], or its tangent"),
    "taps": declare_int(32, (1, 256), "look-ups of the search, and as many of the filter"),
}


class Lookup:
    """A shadow map that averages depth comparisons over a disk as wide as the penumbra.

    light_size : diameter of the light [unit of length]; for a directional light, the tangent of its
        angular diameter.
    taps : number of texels that the search for occluders reads, and again the average.
    """

    def __init__(self, depths: MitsubaObject, light_size: float, taps: int) -> None:
        self.texels, self.light_size, self.taps = Texels(depths), light_size, make_tap_spiral(taps)

    def visibility(self, point: MapPoint) -> JitFloat:
        """Return the share of the light that arrives at a point."""
        width = self.penumbra_width(point, self.mean_occluder_depth(point))
        lit = sum(
            self.texels.visibility(point, u, v) for u, v in self.iterate_tap_places(point, width)
        )
        return lit / len(self.taps)

    def mean_occluder_depth(self, point: MapPoint) -> JitFloat:
        """Return the mean depth on the map of a point's occluders, or its own depth without any."""
        import mitsuba as mi

        total, count = mi.Float(0), mi.Float(0)
        for u, v in self.iterate_tap_places(point, self.penumbra_width(point, mi.Float(-1))):
            occluder, depth = self.texels.read_depths(point, u, v)
            total += dr.select(occluder < depth, dr.maximum(occluder, -1), 0)
            count += dr.select(occluder < depth, mi.Float(1), 0)
        return dr.select(count > 0, total / count, point.depth)

    def penumbra_width(self, point: MapPoint, depth: JitFloat) -> JitFloat:
        """Return the width of the penumbra [unit of length] if the occluder has this `depth`."""
        occluder, light = point.move_to_depth(depth), point.projection.light
        gap = dr.norm(occluder - point.p)
        if not light.is_directional:
            gap = gap / dr.norm(occluder - type(occluder)(light.point.xyz))
        return self.light_size * gap

    def iterate_tap_places(
        self, point: MapPoint, width: JitFloat
    ) -> Iterator[tuple[JitFloat, JitFloat]]:
        """Yield the places (u, v) [texels] to read in a disk around a point that faces the light.

        width : diameter of the disk in the world [unit of length].
        """
        (u_s, v_s), (u_t, v_t) = point.cross_section_axes()
        for s, t in self.taps:
            x, y = s * width / 2, t * width / 2
            yield point.u + x * u_s + y * u_t, point.v + x * v_s + y * v_t


def make_tap_spiral(n: int) -> list[tuple[float, float]]:
    """Return n points of the unit disk, spread evenly over its area on a golden-angle spiral."""
    golden = math.pi * (3 - math.sqrt(5))
    return [
        (
            math.sqrt((i + 0.5) / n) * math.cos(i * golden),
            math.sqrt((i + 0.5) / n) * math.sin(i * golden),
        )
        for i in range(n)
    ]
