"""Exponential variance shadow map (EVSM): a variance shadow map of depths that are warped first.

    z⁺ = exp(c⁺ z),  z⁻ = -exp(-c⁻ z);   lit = min(p_max(z⁺), p_max(z⁻))

z is the depth, and c⁺ and c⁻ are the settings `exponent` and `negative_exponent`. p_max is the
upper bound on the share of light that the mean and the variance of a warped depth allow, as in a
variance shadow map.

The problem of a variance shadow map is light that leaks into a shadow where two occluders are
behind each other. The warp z⁺ stretches the far depths most, so hardly any light leaks, unless the
receiver is close behind the second occluder; there the bound by z⁻ is lower. A c⁻ of 0 leaves out
that bound, which halves the memory. Exponents above 40 would exceed 3e38, the range of single
precision.

[Lauritzen & McCool 2008]
"""

import drjit as dr

from brdfkit.core.array_types import JitFloat, MitsubaObject
from brdfkit.mitsuba_bridge.properties.declarations import declare_float
from brdfkit.shadows.maps.map_point import MapPoint
from brdfkit.shadows.maps.moments import moving_depths
from brdfkit.shadows.maps.moments.bounds import bound_by_two_moments
from brdfkit.shadows.maps.moments.moment_map import BLEEDING, BLUR, MomentMap

SETTINGS = {
    "blur": BLUR,
    "bleeding": BLEEDING,
    "exponent": declare_float(20.0, (0.1, 40.0), "c⁺, of depths in [-1, 1]"),
    "negative_exponent": declare_float(5.0, (0.0, 40.0), "c⁻; 0 leaves this bound out"),
}
render_map = moving_depths.render_map
# Smallest standard deviation of depths in [-1, 1]; rounding errors exceed the variance below it
LEAST_DEVIATION = 1e-3


class Lookup:
    """A variance shadow map of exponentially warped depths, with two moments of each of them."""

    def __init__(
        self,
        depths: moving_depths.MovingDepths,
        blur: int,
        bleeding: float,
        exponent: float,
        negative_exponent: float,
    ) -> None:
        # Pairs of a warp of depth z and its relative slope |warp'(z) / warp(z)|, the exponent
        self.warps = [(lambda z: dr.exp(exponent * z), exponent)]
        if negative_exponent:
            self.warps.append((lambda z: -dr.exp(-negative_exponent * z), negative_exponent))
        self.moments = MomentMap(self.compute_warped_powers, depths, blur, bleeding)

    def compute_warped_powers(self, depths: MitsubaObject) -> list[MitsubaObject]:
        """Return the warped depths and their squares, one after the other, for each warp."""
        return [x for warp, _ in self.warps for x in (warp(depths), dr.square(warp(depths)))]

    def visibility(self, point: MapPoint) -> JitFloat:
        """Return the greatest share of the light that may arrive at a point."""
        depth = dr.clip(point.depth, -1, 1)

        def bound_by_all_warps(means: list[JitFloat]) -> JitFloat:
            bound: JitFloat = 1
            for i, (warp, steepness) in enumerate(self.warps):
                t = warp(depth)
                least = dr.square(LEAST_DEVIATION * steepness * t)
                mean, square = means[2 * i], means[2 * i + 1]
                bound = dr.minimum(bound, bound_by_two_moments(mean, square, t, least))
            return bound

        return self.moments.bound_light(point, bound_by_all_warps)
