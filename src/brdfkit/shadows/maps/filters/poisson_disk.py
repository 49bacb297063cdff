"""Poisson-disk filter: percentage-closer over 12 random taps in a disk, none too close to another.

    lit = 1/12 Σ_k [z ≤ f(u + r x_k, v + r y_k)]

z is the depth of the point, f that in the map. The disk may have any radius r at the same cost. It
may shrink to nothing towards the upper end of the map (`taper`), where a shadow then becomes sharp.
The same 12 taps serve every point: wide borders show 12 copies of the edge.

[Mitchell 2004], [Ergun 2008, 2.2.1.3]
"""

import functools

import numpy as np

from brdfkit.core.array_types import FloatArray, JitFloat, MitsubaObject
from brdfkit.mitsuba_bridge.properties.declarations import declare_float
from brdfkit.shadows.maps.map_point import MapPoint
from brdfkit.shadows.maps.texels import Texels

TAPS = 12
LEAST_DISTANCE = 0.5  # between two taps, in radii of the disk

SETTINGS = {
    "radius": declare_float(2.0, (0.0, 256.0), "of the disk [texels]"),
    "taper": declare_float(0.0, (0.0, 1.0), "by how much of it the radius falls up to the top"),
}


class Lookup:
    """The mean of comparisons at the 12 taps."""

    def __init__(self, depths: MitsubaObject, radius: float, taper: float) -> None:
        self.texels, self.radius, self.taper = Texels(depths), radius, taper

    def lit_share(self, point: MapPoint) -> JitFloat:
        """Return the share of the light that arrives at a point."""
        r = self.radius * (1 - self.taper / self.texels.resolution * point.v)
        places = [(point.u + r * x, point.v + r * y) for x, y in draw_taps()]
        return sum(self.texels.lit_share(point, u, v) / TAPS for u, v in places)


@functools.cache
def draw_taps() -> FloatArray:
    """Draw random points (12, 2) of the unit disk, leaving out those too close to another."""
    generator = np.random.default_rng(1)
    taps: list[FloatArray] = []
    while len(taps) < TAPS:
        point = generator.uniform(-1, 1, 2)
        apart = [np.hypot(*(point - other)) >= LEAST_DISTANCE for other in taps]
        if np.hypot(*point) <= 1 and all(apart):
            taps.append(point)
    return np.array(taps)
