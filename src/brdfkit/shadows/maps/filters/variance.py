"""Variance shadow map (VSM): a bound on the light from mean and variance of the depths near by.

    lit = p_max = σ² / (σ² + (z - μ)²) where z > μ, else 1;   lit' = (lit - ε)₊ / (1 - ε)

μ = E(f) and σ² = E(f²) - μ² come of two moments that are blurred and interpolated as a picture is,
once for all points. Of one plane above another the bound is the share itself, that of the
percentage-closer filter. Where two occluders are behind each other the variance is large, and light
bleeds into the shadow of the farther; shares below ε (`bleeding`) are therefore taken for none,
which narrows true borders, too. The borders are soft and have derivatives.

[Donnelly & Lauritzen 2006], [Ergun 2008, 2.2.1.4]
"""

import drjit as dr

from brdfkit.mitsuba_bridge.properties.declarations import plain_number
from brdfkit.shadows.maps.moments import moving_depths
from brdfkit.shadows.maps.moments.chebyshev import most_lit
from brdfkit.shadows.maps.moments.moment_map import BLEEDING, BLUR, MomentMap, without_bleeding

SETTINGS = {
    "blur": BLUR,
    "bleeding": BLEEDING,
    "least_deviation": plain_number(3e-4, (0.0, 1.0), "of depths, over half the map's range"),
}
see = moving_depths.see


class Lookup:
    """Two moments of depth, blurred."""

    def __init__(self, depths, blur, bleeding, least_deviation):
        self.moments = MomentMap(lambda z: [z, z * z], depths, blur)
        self.bleeding, self.least_variance = bleeding, least_deviation**2

    def lit(self, point):
        """The greatest share of the light that may arrive at a `MapPoint`."""
        bound = most_lit(*self.moments.at(point), point.depth, self.least_variance)
        return dr.select(self.moments.within(point), without_bleeding(bound, self.bleeding), 1)
