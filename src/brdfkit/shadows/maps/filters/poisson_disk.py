"""Poisson-disk filter: percentage-closer over 12 random taps in a disk, none too close to another.

    lit = 1/12 Σ_k [z ≤ f(u + r x_k, v + r y_k)]

z is the depth of the point, f(u, v) the depth in the texel at (u, v), and (x_k, y_k) are the taps
in the unit disk. A disk of any radius r costs the same. The setting `taper` lets the radius shrink
towards the upper end of the map, where shadows then become sharper. The same 12 taps serve every
point, so that wide borders show 12 copies of the edge.

[Mitchell 2004], [Ergun 2008, 2.2.1.3]
"""

import functools

import numpy as np

from brdfkit.core.array_types import FloatArray, JitFloat, MitsubaObject
from brdfkit.mitsuba_bridge.properties.declarations import declare_float
from brdfkit.shadows.maps.map_point import MapPoint
from brdfkit.shadows.maps.texels import Texels

TAPS = 12
LEAST_DISTANCE = 0.5  # the least distance between two taps, in radii of the disk

SETTINGS = {
    "radius": declare_float(2.0, (0.0, 256.0), "of the disk [texels]"),
    "taper": declare_float(0.0, (0.0, 1.0), "by how much of it the radius falls up to the top"),
}


class Lookup:
    """A shadow map that averages depth comparisons at 12 taps around a point.

    radius : radius of the disk of taps at the lower end of the map [texels].
    taper : share by which the radius shrinks up to the upper end of the map.
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
