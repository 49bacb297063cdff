"""The trapezoid around the visible body becomes the map, mostly for what is near the eye (TSM).

Two sides of the trapezoid are at right angles to the line of sight, at the near and the far end of
the visible body, λ apart. The two others touch the body, and meet η before the near side:

    η = λ δ (1 + ξ) / (λ - 2 δ - λ ξ),  ξ = -0.6

so that the first δ behind the near side, the focus, gets 80 % of the map [Martin & Tan 2004,
sections 5 and 6]. The matrix N_T of the trapezoid [Ergun 2008, 2.2.2.4] is the perspective that
`LineOfSight.make_warped_projection` makes. The projection is the focused one where the near end is
above the far one, as when the eye looks along the light.

It is good where the focus is known. Depth is divided by the width of the trapezoid, and coarse at
its far end. Where the projection changes to the focused one, shadows change at once.
"""

from brdfkit.mitsuba_bridge.properties.declarations import declare_float
from brdfkit.shadows.maps.line_of_sight import find_line_of_sight
from brdfkit.shadows.maps.placement import Placement
from brdfkit.shadows.maps.projection import Projection
from brdfkit.shadows.maps.projections import focused

XI = -0.6  # the focus ends here on the map, which runs from 1 at its near side to -1 at its far one
SETTINGS = {
    "focus": declare_float(
        0.3, (0.01, 0.79), "of trapezoidal: the share of what is seen that has 80 % of a map"
    )
}


def make_projection(placement: Placement, focus: float) -> Projection:
    """Make the trapezoidal projection; the focused one if the eye looks along the light."""
    sight = find_line_of_sight(placement)
    if sight is None or sight.y_range[0] < 0:
        return focused.make_projection(placement)
    near, far = sight.y_range
    return sight.make_warped_projection((far - near) * focus * (1 + XI) / (1 - 2 * focus - XI))
