"""A usual camera at the light that sees the whole scene, wherever the eye is [Ergun 2008, 2.2.2.1].

Points far from the light but near the eye get few texels.
"""

from brdfkit.shadows.maps.light_camera import around


def projection(placement):
    return around(placement.light, placement.scene)
