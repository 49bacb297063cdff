"""The uniform projection, fitted to what the camera sees and what may shadow it.

[Ergun 2008, 2.2.2.1], with the body of Ogre's focused set-up: ((V ∩ S) + light) ∩ S.
"""

from brdfkit.shadows.maps.light_camera import around


def projection(placement):
    return around(placement.light, placement.body)
