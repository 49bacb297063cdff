"""Exponential variance shadow map (EVSM): variance shadow maps of depths that are warped first.

    z⁺ = exp(c⁺ z),  z⁻ = -exp(-c⁻ z);   lit = min(p_max(z⁺), p_max(z⁻))

The exponential makes gaps between far occluders nothing beside one to the nearest, so that hardly
any light bleeds into a second shadow far behind it. It leaks where the receiver is close behind the
second; there the other bound, of z⁻, is the lower one. An exponent of 0 leaves that out, which
halves the memory. Exponents are limited by the numbers' range, 3e38.

[Lauritzen & McCool 2008]
"""

import drjit as dr

from brdfkit.mitsuba_bridge.properties.declarations import plain_number
from brdfkit.shadows.maps.moments import moving_depths
from brdfkit.shadows.maps.moments.chebyshev import most_lit
from brdfkit.shadows.maps.moments.moment_map import BLEEDING, BLUR, MomentMap, without_bleeding

SETTINGS = {
    "blur": BLUR,
    "bleeding": BLEEDING,
    "exponent": plain_number(20.0, (0.1, 40.0), "c⁺, of depths in [-1, 1]"),
    "negative_exponent": plain_number(5.0, (0.0, 40.0), "c⁻; 0 leaves this bound out"),
}
see = moving_depths.see
LEAST = 1e-3  # deviation of depths, over half the map's range, against rounding


class Lookup:
    """Two moments of each of the two warped depths, blurred."""

    def __init__(self, depths, blur, bleeding, exponent, negative_exponent):
        # each warp: its function, and its slope over its value
        self.warps = [(lambda z: dr.exp(exponent * z), exponent)]
        if negative_exponent:
            self.warps.append((lambda z: -dr.exp(-negative_exponent * z), negative_exponent))
        self.moments = MomentMap(self.powers, depths, blur)
        self.bleeding = bleeding

    def powers(self, depths):
        """The warped depths and their squares, in pairs."""
        return [x for warp, _ in self.warps for x in (warp(depths), dr.square(warp(depths)))]

    def lit(self, point):
        """The greatest share of the light that may arrive at a `MapPoint`."""
        found, bound = self.moments.at(point), 1
        depth = dr.clip(point.depth, -1, 1)
        for i, (warp, steepness) in enumerate(self.warps):
            t = warp(depth)
            least = dr.square(LEAST * steepness * t)
            bound = dr.minimum(bound, most_lit(*found[2 * i : 2 * i + 2], t, least))
        return dr.select(self.moments.within(point), without_bleeding(bound, self.bleeding), 1)
