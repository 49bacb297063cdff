"""A perspective across the map along the line of sight, of the best strength on average (LiSPSM).

    n = (z_n + √(z_n z_f)) / sin γ, times `apex`

n is the distance of the perspective's apex, γ the angle between view and light [Ergun 2008,
2.2.2.3]; z_n and z_f are the depths between which the camera sees something. With this n the worst
error near the eye equals the worst far from it [Wimmer et al. 2004]. The directions of light and
depth do not change. As γ → 0 the map becomes the focused one, which is also used where the eye is
behind the light. If the light is a point or spot, its own perspective comes first. The projection
is good for wide views at right angles to the light; at other angles, texels change when the eye
turns.
"""

import numpy as np

from brdfkit.shadows.maps.line_of_sight import APEX, find_line_of_sight
from brdfkit.shadows.maps.placement import Placement
from brdfkit.shadows.maps.projection import Projection
from brdfkit.shadows.maps.projections import focused

SETTINGS = {"apex": APEX}


def make_projection(placement: Placement, apex: float) -> Projection:
    """Make the light-space perspective projection; the focused one if there is no line of sight."""
    sight = find_line_of_sight(placement)
    if sight is None:
        return focused.make_projection(placement)
    z_n, z_f = placement.depths
    n = (z_n + np.sqrt(z_n * z_f)) / sight.sine_to_light
    return sight.make_warped_projection(apex * n * sight.map_scale)
