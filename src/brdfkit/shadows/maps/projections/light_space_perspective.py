"""Light-space perspective shadow maps (LiSPSM): a perspective that makes texels finer near the eye.

The light's own camera projects the scene first, orthographically or, for a point or spot light, by
a perspective. Then a second perspective warps the map along the line of sight. Its apex is before
the visible part at the distance

    n = (z_n + √(z_n z_f)) / sin γ

times the setting `apex`. γ is the angle between view and light [Ergun 2008, 2.2.2.3], and z_n and
z_f are the depths between which the camera sees something. With this n the largest aliasing error
near the eye equals the largest one far from it [Wimmer et al. 2004]. As γ → 0, n grows and the map
becomes the focused one, which is also used where the eye is behind the light.

The projection is good for wide views at right angles to the light. At other angles, texels change
when the eye turns.
"""

import numpy as np

from brdfkit.shadows.maps.line_of_sight import APEX, find_line_of_sight
from brdfkit.shadows.maps.placement import Placement
from brdfkit.shadows.maps.projection import Projection
from brdfkit.shadows.maps.projections import focused

SETTINGS = {"apex": APEX}


def make_projection(placement: Placement, apex: float) -> Projection:
    """Make the light-space perspective projection; the focused one if the map has no line of sight.

    apex : factor of the distance of the perspective's apex; below 1, it favours what is near.
    """
    sight = find_line_of_sight(placement)
    if sight is None:
        return focused.make_projection(placement)
    z_n, z_f = placement.visible_depths
    n = (z_n + np.sqrt(z_n * z_f)) / sight.sine_to_light
    return sight.make_warped_projection(apex * n * sight.map_scale)
