"""A cube of six shadow maps around a point light, for a light among the objects that cast shadows.

Each face of the cube is treated as a spot light of 90° along an axis of the world, with a map of
its own, of any projection. Faces in which the camera sees nothing have no map. With the projection
`uniform`, texels are not equally fine: one in a corner of a face covers only a fifth (cos³θ, θ the
angle from the axis) of the solid angle of one in the middle.
"""

from collections.abc import Callable
from dataclasses import replace

import drjit as dr
import numpy as np

from brdfkit.core.array_types import FloatArray, JitInt, JitVector
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.projective.light import Light
from brdfkit.shadows.maps.partition import Partition, Setup, make_partition_from_placements

FACES = np.vstack([np.eye(3), -np.eye(3)])  # normals of the faces: +x, +y, +z, -x, -y, -z


def make_partition(setup: Setup) -> Partition:
    """Make a partition with a map for each of six faces around a point or spot light.

    Raises `BrdfkitError` for a directional light.
    """
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
