"""A cube of maps around a point light, for a light among the objects that it shadows.

Each face is a square spot light of 90°, along an axis of the world, and has a map of its own, of
any projection. Faces in which the camera sees nothing have none. On a plain face, a texel in a
corner has a fifth, cos³θ, of the solid angle of one in the middle: the middle is the coarsest part.
"""

from collections.abc import Callable
from dataclasses import replace

import drjit as dr
import numpy as np

from brdfkit.core.array_types import FloatArray, JitInt, JitVector
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.projective.light import Light
from brdfkit.shadows.maps.partition import Partition, Setup, make_parts

FACES = np.vstack([np.eye(3), -np.eye(3)])  # along x, y, z, and back


def make_partition(setup: Setup) -> Partition:
    """Make a partition of the six faces; raise `BrdfkitError` for a directional light."""
    light = setup.placement.light
    if light.is_directional:
        raise BrdfkitError(
            "a cube of maps is around a light at a place; of one far away use parallel_split."
        )
    faces = [replace(setup.placement, light=Light(light.point, axis, np.pi / 4)) for axis in FACES]
    return make_parts(setup, faces, make_face_finder(light.point[:3]))


def make_face_finder(centre: FloatArray) -> Callable[[JitVector], JitInt]:
    """Return the function from points to the indices of their faces around a `centre` (3,)."""
    import mitsuba as mi

    middle = mi.Point3f(centre)
    dr.make_opaque(middle)

    def face_of(p: JitVector) -> JitInt:
        way = p - middle
        size = dr.abs(way)
        longest = dr.select(size.y > size.x, mi.UInt32(1), 0)
        longest = dr.select(size.z > dr.maximum(size.x, size.y), 2, longest)
        along = dr.select(longest == 0, way.x, dr.select(longest == 1, way.y, way.z))
        return longest + dr.select(along < 0, mi.UInt32(3), 0)

    return face_of
