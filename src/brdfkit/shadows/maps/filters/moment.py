"""Moment shadow map (MSM): the sharpest bound on the light from four moments of nearby depths.

    lit = max { P(X ≥ z) : E(X) = b₁ ... E(X⁴) = b₄ }

X is the random depth of the texels near the point, z the depth of the point, and b₁ to b₄ are the
means of X, X², X³ and X⁴, which the map stores. Among all distributions of X with these moments,
lit is the largest share of depths that are not nearer than z (a Hamburger moment problem). It is
exact for two occluding planes above a third plane, where a variance shadow map leaks light.

Where X has only one or two different depths, rounding errors of the moments matter. So a small
share, the setting `rounding`, of fixed moments is mixed in, which lets some light through.

The bound is so sharp that it would darken slanted surfaces, as half of the texels around a point on
them are nearer to the light. So with a bias that follows the surface's plane (`Bias.plane`), z is
the least depth that this plane has within half a texel of the point.

[Peters & Klein 2015]
"""

import drjit as dr

from brdfkit.core.array_types import JitFloat
from brdfkit.mitsuba_bridge.properties.declarations import declare_float
from brdfkit.shadows.maps.map_point import MapPoint
from brdfkit.shadows.maps.moments import moving_depths
from brdfkit.shadows.maps.moments.bounds import bound_by_four_moments
from brdfkit.shadows.maps.moments.moment_map import BLEEDING, BLUR, MomentMap

SETTINGS = {
    "blur": BLUR,
    "bleeding": BLEEDING,
    "rounding": declare_float(3e-5, (0.0, 0.1), "by how much moments are drawn to the middle"),
}
render_map = moving_depths.render_map


class Lookup:
    """A moment shadow map, which bounds the light by four blurred moments of depth."""

    def __init__(
        self, depths: moving_depths.MovingDepths, blur: int, bleeding: float, rounding: float
    ) -> None:
        self.moments = MomentMap(lambda z: [z, z * z, z**3, z**4], depths, blur, bleeding)
        self.rounding = rounding

    def visibility(self, point: MapPoint) -> JitFloat:
        """Return the greatest share of the light that may arrive at a point."""
        depth = point.depth - (dr.abs(point.slope_u) + dr.abs(point.slope_v)) / 2
        depth = dr.clip(depth, -1, 1)
        return self.moments.bound_light(
            point, lambda means: bound_by_four_moments(means, depth, self.rounding)
        )
