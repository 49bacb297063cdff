"""Percentage-closer soft shadows (PCSS): a percentage-closer filter as wide as the penumbra.

    w = w_light (d_r - d_b) / d_b

w is the width of the penumbra and w_light that of the light, d_r the receiver's distance from the
light. d_b is the mean distance of the occluders that a search finds, as if all of them were a plane
parallel to the light. The search takes the cone from the receiver to the light, up to the map's
near side. Both look at taps on a spiral in a disk that is round in the world, whatever the
projection does to it. `light_size` gives the scene's point light a size; for a light far away it is
the tangent of its diameter, 0.0093 for the sun.

Occluders behind others are not seen, and the mean over several depths is none of them: overlapping
penumbrae are wrong, and contacts a little too light.

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
    """A search for occluders, then the mean of comparisons over a disk."""

    def __init__(self, depths: MitsubaObject, light_size: float, taps: int) -> None:
        self.texels, self.light_size, self.taps = Texels(depths), light_size, make_spiral(taps)

    def lit_share(self, point: MapPoint) -> JitFloat:
        """Return the share of the light that arrives at a point."""
        width = self.penumbra_width(point, self.mean_occluder_depth(point))
        lit = sum(self.texels.lit_share(point, u, v) for u, v in self.places(point, width))
        return lit / len(self.taps)

    def mean_occluder_depth(self, point: MapPoint) -> JitFloat:
        """Return the mean depth of occluders in the map's cube; the point's own without any."""
        import mitsuba as mi

        total, count = mi.Float(0), mi.Float(0)
        for u, v in self.places(point, self.penumbra_width(point, mi.Float(-1))):
            occluder, depth = self.texels.depths_at(point, u, v)
            total += dr.select(occluder < depth, dr.maximum(occluder, -1), 0)
            count += dr.select(occluder < depth, mi.Float(1), 0)
        return dr.select(count > 0, total / count, point.depth)

    def penumbra_width(self, point: MapPoint, depth: JitFloat) -> JitFloat:
        """Return w [unit of length] for occluders at a `depth` in the map's cube."""
        occluder, light = point.move_to_depth(depth), point.projection.light
        gap = dr.norm(occluder - point.p)
        if not light.is_directional:
            gap = gap / dr.norm(occluder - type(occluder)(light.point.xyz))
        return self.light_size * gap

    def places(self, point: MapPoint, width: JitFloat) -> Iterator[tuple[JitFloat, JitFloat]]:
        """Yield the taps on the map, in a disk of this diameter about the point and the light."""
        (u_s, v_s), (u_t, v_t) = point.cross_section_axes()
        for s, t in self.taps:
            x, y = s * width / 2, t * width / 2
            yield point.u + x * u_s + y * u_t, point.v + x * v_s + y * v_t


def make_spiral(n: int) -> list[tuple[float, float]]:
    """Return n points of the unit disk, evenly by area, each turned by the golden angle."""
    golden = math.pi * (3 - math.sqrt(5))
    return [
        (
            math.sqrt((i + 0.5) / n) * math.cos(i * golden),
            math.sqrt((i + 0.5) / n) * math.sin(i * golden),
        )
        for i in range(n)
    ]
