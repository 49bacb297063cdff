"""Variance shadow map (VSM): a bound on the light from mean and variance of nearby depths.

    lit = p_max = σ² / (σ² + (z - μ)²) where z > μ, else 1;   lit' = (lit - ε)₊ / (1 - ε)

z is the depth of the point, and f are the depths in the texels around it, with the mean μ = E(f)
and the variance σ² = E(f²) - μ². The map stores E(f) and E(f²), which can be blurred once for all
points, and interpolated like a picture. The borders are soft and have derivatives.

For one plane above another, lit equals the share that a percentage-closer filter finds. Where two
occluders are behind each other, the variance is large, and light leaks into the shadow of the
farther one. So shares below ε, the setting `bleeding`, become 0, which also narrows true borders.

[Donnelly & Lauritzen 2006], [Ergun 2008, 2.2.1.4]
"""

from brdfkit.core.array_types import JitFloat
from brdfkit.mitsuba_bridge.properties.declarations import declare_float
from brdfkit.shadows.maps.map_point import MapPoint
from brdfkit.shadows.maps.moments import moving_depths
from brdfkit.shadows.maps.moments.bounds import bound_by_two_moments
from brdfkit.shadows.maps.moments.moment_map import BLEEDING, BLUR, MomentMap

SETTINGS = {
    "blur": BLUR,
    "bleeding": BLEEDING,
    "least_deviation": declare_float(3e-4, (0.0, 1.0), "of depths, over half the map's range"),
}
render_map = moving_depths.render_map


class Lookup:
    """A variance shadow map, which bounds the light by blurred means of depth and its square."""

    def __init__(
        self, depths: moving_depths.MovingDepths, blur: int, bleeding: float, least_deviation: float
    ) -> None:
        self.moments = MomentMap(lambda z: [z, z * z], depths, blur, bleeding)
        self.least_variance = least_deviation**2

    def visibility(self, point: MapPoint) -> JitFloat:
        """Return the greatest share of the light that may arrive at a point."""

        def bound(means: list[JitFloat]) -> JitFloat:
            mean, square = means
            return bound_by_two_moments(mean, square, point.depth, self.least_variance)

        return self.moments.bound_light(point, bound)
