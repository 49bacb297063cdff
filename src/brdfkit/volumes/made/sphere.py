"""A sphere of radius 1/2 and value 1 in a cube of edge 2, about the origin.

Each voxel has the share of it that lies in the sphere, by 4³ points; so the sum of the voxels times
the volume of one is nearly (4/3) π / 8. Rays at the distance b of the middle cross 2 √(1/4 - b²) of
it: `chord`.
"""

import numpy as np

from brdfkit.volumes.made._grid import centres, filling_cube
from brdfkit.volumes.volume import Volume

SIZE = 64
BYTES = 12  # that a voxel takes while it is made
RADIUS = 0.5
POINTS = 4  # along each axis of a voxel


def make(size):
    """The sphere, its surface smooth to a voxel."""
    fine = tuple(POINTS * n for n in size)
    x, y, z = centres(fine, filling_cube(fine, 1.0))
    values = np.empty(size[::-1], np.float32)
    for k in range(size[2]):
        inside = x**2 + y**2 + z[POINTS * k : POINTS * (k + 1)] ** 2 < RADIUS**2
        blocks = inside.reshape(POINTS, size[1], POINTS, size[0], POINTS)
        values[k] = blocks.mean(axis=(0, 2, 4))
    return Volume(values, filling_cube(size, 1.0), "sphere")


def chord(distance):
    """The length of a ray within the sphere, at this `distance` from the middle."""
    return 2 * np.sqrt(np.maximum(RADIUS**2 - np.square(distance), 0))
