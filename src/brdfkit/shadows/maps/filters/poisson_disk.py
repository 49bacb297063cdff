"""Poisson-disk filter: averages depth comparisons at 12 random places (taps) in a disk.

    lit = 1/12 Σ_k [z ≤ f(u + r x_k, v + r y_k)]

lit is the share of the light that arrives. z is the depth of the point, (u, v) its place on the map
and f the depth in the texel at a place; a comparison [...] is 1 or 0. The taps (x_k, y_k) are
points of the unit disk, none too close to another. A disk of any radius r costs the same. The
setting `taper` makes the radius shrink towards the upper end of the map, and so shadows sharper.
The same 12 taps serve every point, so wide borders show 12 copies of the edge.

[Mitchell 2004], [Ergun 2008, 2.2.1.3]
"""

import functools

import numpy as np

from brdfkit.core.array_types import FloatArray, JitFloat, MitsubaObject
from brdfkit.mitsuba_bridge.properties.declarations import declare_float
from brdfkit.shadows.maps.map_point import MapPoint
from brdfkit.shadows.maps.texels import Texels

TAPS = 12
LEAST_DISTANCE = 0.5  # smallest distance between two taps, as a multiple of the disk's radius

SETTINGS = {
    "radius": declare_float(2.0, (0.0, 256.0), "of the disk [texels]"),
    "taper": declare_float(0.0, (0.0, 1.0), "by how much of it the radius falls up to the top"),
}


class Lookup:
    """A shadow map that averages depth comparisons at 12 taps around a point.

    radius : radius of the disk of taps at the lower end of the map (v = 0) [texels].
    taper : share of the radius by which it shrinks from the lower to the upper end of the map.
    """

    def __init__(self, depths: MitsubaObject, radius: float, taper: float) -> None:
        self.texels, self.radius, self.taper = Texels(depths), radius, taper

    def visibility(self, point: MapPoint) -> JitFloat:
        """Return the share of the light that arrives at a point."""
        r = self.radius * (1 - self.taper / self.texels.resolution * point.v)
        places = [(point.u + r * x, point.v + r * y) for x, y in draw_taps()]
        return sum(self.texels.visibility(point, u, v) / TAPS for u, v in places)


@functools.cache
def draw_taps() -> FloatArray:
    """Draw 12 random points (12, 2) of the unit disk, no two closer than `LEAST_DISTANCE`."""
    generator = np.random.default_rng(1)
    taps: list[FloatArray] = []
    while len(taps) < TAPS:
        point = generator.uniform(-1, 1, 2)
        apart = [np.hypot(*(point - other)) >= LEAST_DISTANCE for other in taps]
        if np.hypot(*point) <= 1 and all(apart):
            taps.append(point)
    return np.array(taps)
