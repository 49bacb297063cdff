"""A perspective across the map along the line of sight, of the best strength in the mean (LiSPSM).

    n = (z_n + √(z_n z_f)) / sin γ, times `apex`

at which the worst error near the eye and the worst far from it are equal [Wimmer et al. 2004]; γ is
the angle between view and light [Ergun 2008, 2.2.2.3]. The directions of light and depth stay, and
as γ → 0 the map becomes the focused one, which it is also where the eye is not before the light.
A point or spot light's own perspective comes first. Good for wide views at right angles to the
light; the texels of all else change when the eye turns.
"""

import numpy as np

from brdfkit.shadows.maps.projections import focused
from brdfkit.shadows.maps.sight import APEX, line_of_sight

SETTINGS = {"apex": APEX}


def projection(placement, apex):
    sight = line_of_sight(placement)
    if sight is None:
        return focused.projection(placement)
    z_n, z_f = placement.depths
    n = (z_n + np.sqrt(z_n * z_f)) / sight.sine
    return sight.warped(apex * n * sight.scale)
