"""Moment shadow map (MSM): the sharpest bound on the light from four moments of the depths near by.

    lit = max { P(X ≥ z) : E(X) = b₁ ... E(X⁴) = b₄ }

is the solution of a moment problem of Hamburger's. Of two planes above a third it is the share
itself, where a variance shadow map leaks. Moments nearly of fewer depths are sensitive to rounding:
they are drawn towards the middle by `rounding`, which lets some light through. The bound is sharp
enough to see that half of a slanted surface's own window is nearer to the light than the point;
where the bias follows planes, the point has the least depth of its plane within half a texel.

[Peters & Klein 2015]
"""

import drjit as dr

from brdfkit.mitsuba_bridge.properties.declarations import plain_number
from brdfkit.shadows.maps.moments import moving_depths
from brdfkit.shadows.maps.moments.bounds import most_lit
from brdfkit.shadows.maps.moments.moment_map import BLEEDING, BLUR, MomentMap, without_bleeding

SETTINGS = {
    "blur": BLUR,
    "bleeding": BLEEDING,
    "rounding": plain_number(3e-5, (0.0, 0.1), "by how much moments are drawn to the middle"),
}
see = moving_depths.see


class Lookup:
    """Four moments of depth, blurred."""

    def __init__(self, depths, blur, bleeding, rounding):
        self.moments = MomentMap(lambda z: [z, z * z, z**3, z**4], depths, blur)
        self.bleeding, self.rounding = bleeding, rounding

    def lit(self, point):
        """The greatest share of the light that may arrive at a `MapPoint`."""
        depth = point.depth - (dr.abs(point.slope_u) + dr.abs(point.slope_v)) / 2
        depth = dr.clip(depth, -1, 1)
        bound = most_lit(self.moments.at(point), depth, self.rounding)
        return dr.select(self.moments.within(point), without_bleeding(bound, self.bleeding), 1)
