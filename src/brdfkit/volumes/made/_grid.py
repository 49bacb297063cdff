"""The grids of made volumes: voxels that fill a cube about the origin."""

import numpy as np


def filling_cube(size, half_width):
    """(4, 4) of `size` (nx, ny, nz) voxels that fill a cube, from -`half_width` to `half_width`."""
    spacing = 2 * half_width / np.array(size, float)
    to_world = np.diag([*spacing, 1])
    to_world[:3, 3] = spacing / 2 - half_width
    return to_world


def centres(size, to_world):
    """The x, y and z of the voxels' centres, to be broadcast to (nz, ny, nx)."""
    x, y, z = (to_world[i, i] * np.arange(n) + to_world[i, 3] for i, n in enumerate(size))
    return x, y[:, None], z[:, None, None]
