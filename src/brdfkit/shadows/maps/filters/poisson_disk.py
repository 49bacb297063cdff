"""Poisson-disk filter: percentage-closer over 12 taps that lie at random in a disk, none too close.

    lit = 1/12 Σ_k [z ≤ f(u + r x_k, v + r y_k)]

The disk may be any size at the same cost, down to nothing towards the upper end of the map
(`taper`), where a shadow that lies there becomes sharp. The same 12 taps serve every point: wide
borders show 12 copies of the edge.

[Mitchell 2004], [Ergun 2008, 2.2.1.3]
"""

import functools

import numpy as np

from brdfkit.mitsuba_bridge.properties.declarations import plain_number
from brdfkit.shadows.maps.texels import Texels

TAPS, APART = 12, 0.5  # the distance, in radii of the disk, that taps keep

SETTINGS = {
    "radius": plain_number(2.0, (0.0, 256.0), "of the disk [texels]"),
    "taper": plain_number(0.0, (0.0, 1.0), "by how much of it the radius falls up to the top"),
}


class Lookup:
    """The mean of comparisons at the 12 taps."""

    def __init__(self, depths, radius, taper):
        self.texels, self.radius, self.taper = Texels(depths), radius, taper

    def lit(self, point):
        """The share of the light that arrives at a `MapPoint`."""
        r = self.radius * (1 - self.taper / self.texels.resolution * point.v)
        return sum(
            self.texels.lit(point, point.u + r * x, point.v + r * y) / TAPS for x, y in taps()
        )


@functools.cache
def taps():
    """Points (12, 2) of the unit disk: drawn one by one, dropped where too close to another."""
    generator = np.random.default_rng(1)
    found = []
    while len(found) < TAPS:
        point = generator.uniform(-1, 1, 2)
        if np.hypot(*point) <= 1 and all(np.hypot(*(point - other)) >= APART for other in found):
            found.append(point)
    return np.array(found)
