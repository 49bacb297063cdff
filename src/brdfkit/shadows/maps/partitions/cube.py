"""A cube of maps around a light at a place, for one among what it shadows.

Each face is a square spot light of 90°, along an axis of the world, and has a map of its own, of
any projection. Faces in which the camera sees nothing have none. Of a plain face, a texel in a
corner has a fifth of the solid angle of one in the middle, cos³θ: the middle is the coarsest part.
"""

from dataclasses import replace

import drjit as dr
import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.projective.light import Light
from brdfkit.shadows.maps.partition import filled

FACES = np.vstack([np.eye(3), -np.eye(3)])  # along x, y, z, and back


def partition(scene, placement, project, resolution):
    point = placement.light.point
    if placement.light.is_directional:
        raise BrdfkitError(
            "a cube of maps is around a light at a place; of one far away use parallel_split."
        )
    faces = [replace(placement, light=Light(point, axis, np.pi / 4)) for axis in FACES]
    return filled(faces, project, resolution, around(point[:3]))


def around(centre):
    """The function from points to the numbers of their faces."""
    import mitsuba as mi

    centre = mi.Point3f(centre)
    dr.make_opaque(centre)

    def which(p):
        way = p - centre
        size = dr.abs(way)
        longest = dr.select(size.y > size.x, mi.UInt32(1), 0)
        longest = dr.select(size.z > dr.maximum(size.x, size.y), 2, longest)
        along = dr.select(longest == 0, way.x, dr.select(longest == 1, way.y, way.z))
        return longest + dr.select(along < 0, mi.UInt32(3), 0)

    return which
