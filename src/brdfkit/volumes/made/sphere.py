"""A sphere of radius 1/2 and value 1 around the origin, in a cube of edge 2 with the value 0.

The value of a voxel is the share of its 4³ points that lie in the sphere. The sum of the voxels
times the volume of one is thus nearly the sphere's volume, (4/3) π / 8.
"""

import numpy as np

from brdfkit.volumes.made._cube_grid import Size, make_cube_transform, voxel_centres
from brdfkit.volumes.volume import Volume

SIZE = 64
BYTES = 12  # memory per voxel that `make` needs
RADIUS = 0.5
POINTS = 4  # sample points along each axis of a voxel


def make(size: Size) -> Volume:
    """Make the sphere with `size` (nx, ny, nz) voxels, its surface antialiased."""
    fine = POINTS * size[0], POINTS * size[1], POINTS * size[2]
    x, y, z = voxel_centres(fine, make_cube_transform(fine))
    values = np.empty(size[::-1], np.float32)
    for k in range(size[2]):
        inside = x**2 + y**2 + z[POINTS * k : POINTS * (k + 1)] ** 2 < RADIUS**2
        blocks = inside.reshape(POINTS, size[1], POINTS, size[0], POINTS)
        values[k] = blocks.mean(axis=(0, 2, 4))
    return Volume(values, make_cube_transform(size), "sphere")
