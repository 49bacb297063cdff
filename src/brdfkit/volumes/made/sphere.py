"""A sphere of radius 1/2 and value 1 in a cube of edge 2, about the origin.

The value of a voxel is the share of it that lies in the sphere, by 4³ points; so the sum of the
voxels times the volume of one is nearly (4/3) π / 8.
"""

import numpy as np

from brdfkit.volumes.made._grid import Size, fill_cube, voxel_centres
from brdfkit.volumes.volume import Volume

SIZE = 64
BYTES = 12  # per voxel while the volume is made
RADIUS = 0.5
POINTS = 4  # along each axis of a voxel


def make(size: Size) -> Volume:
    """Make the sphere of `size` voxels, its surface smooth within a voxel."""
    fine = POINTS * size[0], POINTS * size[1], POINTS * size[2]
    x, y, z = voxel_centres(fine, fill_cube(fine, 1.0))
    values = np.empty(size[::-1], np.float32)
    for k in range(size[2]):
        inside = x**2 + y**2 + z[POINTS * k : POINTS * (k + 1)] ** 2 < RADIUS**2
        blocks = inside.reshape(POINTS, size[1], POINTS, size[0], POINTS)
        values[k] = blocks.mean(axis=(0, 2, 4))
    return Volume(values, fill_cube(size, 1.0), "sphere")
