"""A slab whose value rises linearly along z from 1/4 to 13/4, in a cube of edge 2.

The value is 0.25 + 1.5 s at the distance s = z + 1 from the face at z = -1. As an extinction, it
transmits exp(-3.5) = 0.030197 of the light along z. Trilinear reconstruction is exact, except in
half a voxel at both faces, where it is constant.
"""

import numpy as np

from brdfkit.volumes.made._cube_grid import Size, make_cube_transform, voxel_centres
from brdfkit.volumes.volume import Volume

SIZE = 64
BYTES = 5  # memory per voxel that `make` needs
FIRST, SLOPE = 0.25, 1.5


def make(size: Size) -> Volume:
    """Make the slab with `size` (nx, ny, nz) voxels."""
    to_world = make_cube_transform(size)
    _, _, z = voxel_centres(size, to_world)
    values = np.broadcast_to(FIRST + SLOPE * (z + 1), size[::-1]).astype(np.float32)
    return Volume(values, to_world, "slab")
