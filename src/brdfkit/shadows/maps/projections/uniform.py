"""A usual camera at the light that sees the whole scene, wherever the eye is [Ergun 2008, 2.2.2.1].

Points far from the light but near the eye get few texels.
"""

from brdfkit.shadows.maps.light_camera import make_enclosing_projection
from brdfkit.shadows.maps.placement import Placement
from brdfkit.shadows.maps.projection import Projection


def make_projection(placement: Placement) -> Projection:
    """Make the projection that encloses the whole scene."""
    return make_enclosing_projection(placement.light, placement.lit_body)
