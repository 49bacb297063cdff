"""The focused projection: a camera at the light, fitted to all that the view needs.

The map encloses the visible part of the scene and all that may cast shadows on it, and nothing else
[Ergun 2008, 2.2.2.1]. Texels are spread uniformly. The enclosed body, `Placement.relevant_body`, is
the one of the focused camera set-up in the engine Ogre.
"""

from brdfkit.shadows.maps.light_camera import make_enclosing_projection
from brdfkit.shadows.maps.placement import Placement
from brdfkit.shadows.maps.projection import Projection


def make_projection(placement: Placement) -> Projection:
    """Make the projection that encloses what the camera sees, and what may cast shadows on it."""
    return make_enclosing_projection(placement.light, placement.relevant_body)
