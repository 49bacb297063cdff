"""The uniform projection, fitted to the visible part of the scene and all that may shadow it.

[Ergun 2008, 2.2.2.1], with the body of Ogre's focused set-up: ((V ∩ S) + light) ∩ S, for the
camera's frustum V and the scene's box S.
"""

from brdfkit.shadows.maps.light_camera import make_enclosing_projection
from brdfkit.shadows.maps.placement import Placement
from brdfkit.shadows.maps.projection import Projection


def make_projection(placement: Placement) -> Projection:
    """Make the projection that encloses the placement's body."""
    return make_enclosing_projection(placement.light, placement.relevant_body)
