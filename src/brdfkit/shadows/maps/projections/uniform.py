"""The uniform projection: a camera at the light that sees the whole scene [Ergun 2008, 2.2.2.1].

The map does not depend on where the eye is, so things near the eye may get few texels.
"""

from brdfkit.shadows.maps.light_camera import make_enclosing_projection
from brdfkit.shadows.maps.placement import Placement
from brdfkit.shadows.maps.projection import Projection


def make_projection(placement: Placement) -> Projection:
    """Make the projection that encloses all of the scene that the light can reach."""
    return make_enclosing_projection(placement.light, placement.lit_body)
