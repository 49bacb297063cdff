"""A cube of maps around a point light, for a light among the objects that it shadows.

Each face is a square spot light of 90°, along an axis of the world, and has a map of its own, of
any projection. Faces in which the camera sees nothing have no map. With the projection `uniform`, a
texel in a corner of a face covers a fifth, cos³θ, of the solid angle of one in the middle, where
the map is coarsest.
"""

from collections.abc import Callable
from dataclasses import replace

import drjit as dr
import numpy as np

from brdfkit.core.array_types import FloatArray, JitInt, JitVector
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.projective.light import Light
from brdfkit.shadows.maps.partition import Partition, Setup, make_partition_from_placements

FACES = np.vstack([np.eye(3), -np.eye(3)])  # the faces' axes: +x, +y, +z, -x, -y, -z


def make_partition(setup: Setup) -> Partition:
    """Make a partition of the six faces; raise `BrdfkitError` for a directional light."""
    light = setup.placement.light
    if light.is_directional:
        raise BrdfkitError(
            "partition 'cube' surrounds a point or spot light; for a directional light use "
            "parallel_split."
        )
    faces = [replace(setup.placement, light=Light(light.point, axis, np.pi / 4)) for axis in FACES]
    return make_partition_from_placements(setup, faces, make_face_finder(light.point[:3]))


def make_face_finder(centre: FloatArray) -> Callable[[JitVector], JitInt]:
    """Return a function that finds the index in `FACES` of the cube face that a point falls on.

    centre : centre (3,) of the cube.
    """
    import mitsuba as mi

    middle = mi.Point3f(centre)
    dr.make_opaque(middle)

    def find_face(p: JitVector) -> JitInt:
        way = p - middle
        size = dr.abs(way)
        longest = dr.select(size.y > size.x, mi.UInt32(1), 0)
        longest = dr.select(size.z > dr.maximum(size.x, size.y), 2, longest)
        along = dr.select(longest == 0, way.x, dr.select(longest == 1, way.y, way.z))
        return longest + dr.select(along < 0, mi.UInt32(3), 0)

    return find_face
