"""Trapezoidal shadow maps (TSM): a trapezoid around the visible part becomes the square map.

The trapezoid lies on the light's own map. Two of its sides are at right angles to the line of
sight, at the near and the far end of the visible part, λ apart. The two others touch this part, and
meet in an apex at the distance η before the near side. A perspective makes the trapezoid a square:
the matrix N_T of [Ergun 2008, 2.2.2.4], which `LineOfSight.make_warped_projection` makes.

The apex is chosen so that a focus, the first δ behind the near side, gets 80 % of the map, up to
the coordinate ξ = -0.6 [Martin & Tan 2004, sections 5 and 6]:

    η = λ δ (1 + ξ) / (λ - 2 δ - λ ξ)

The setting `focus` is δ / λ. The projection is the focused one where the eye looks along the light.

It is good if the user knows which depths matter. Depth is divided by the width of the trapezoid,
and so it is coarse at the far end. Where the projection changes to the focused one, shadows jump.
"""

from brdfkit.mitsuba_bridge.properties.declarations import declare_float
from brdfkit.shadows.maps.line_of_sight import find_line_of_sight
from brdfkit.shadows.maps.placement import Placement
from brdfkit.shadows.maps.projection import Projection
from brdfkit.shadows.maps.projections import focused

XI = -0.6  # map coordinate, 1 at the near side and -1 at the far one, at which the focus ends
SETTINGS = {
    "focus": declare_float(
        0.3, (0.01, 0.79), "of trapezoidal: the share of what is seen that has 80 % of a map"
    )
}


def make_projection(placement: Placement, focus: float) -> Projection:
    """Make the trapezoidal projection; the focused one if the eye looks along the light.

    focus : share of the visible part's length, from its near end, that gets 80 % of the map.
    """
    sight = find_line_of_sight(placement)
    if sight is None or sight.y_range[0] < 0:
        return focused.make_projection(placement)
    near, far = sight.y_range
    return sight.make_warped_projection((far - near) * focus * (1 + XI) / (1 - 2 * focus - XI))
