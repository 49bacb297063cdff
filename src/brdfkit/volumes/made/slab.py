"""A slab whose value rises linearly along z from 1/4 to 13/4, in a cube of edge 2.

The value is 0.25 + 1.5 s at the distance s = z + 1 from the face at z = -1. Taken as extinction it
lets exp(-3.5) = 0.030197 of the light through along z. Trilinear reconstruction is exact, but for
half a voxel at both faces, where it stays as it is.
"""

import numpy as np

from brdfkit.volumes.made._grid import centres, filling_cube
from brdfkit.volumes.volume import Volume

SIZE = 64
BYTES = 5  # that a voxel takes while it is made
FIRST, SLOPE = 0.25, 1.5


def make(size):
    """The slab."""
    to_world = filling_cube(size, 1.0)
    _, _, z = centres(size, to_world)
    values = np.broadcast_to(FIRST + SLOPE * (z + 1), size[::-1]).astype(np.float32)
    return Volume(values, to_world, "slab")


def optical_depth(distance):
    """∫ of the value over the first `distance` along z."""
    return FIRST * distance + SLOPE * np.square(distance) / 2
