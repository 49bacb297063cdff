"""The grid of synthetic volumes: voxels that fill a cube around the origin."""

import numpy as np

from brdfkit.core.array_types import FloatArray

Size = tuple[int, int, int]


def make_cube_transform(size: Size) -> FloatArray:
    """Return the transform (4, 4) from voxels' indices to the world, for a grid on [-1, 1]³.

    `size` (nx, ny, nz) are the numbers of voxels.
    """
    spacing = 2 / np.array(size, float)
    to_world = np.diag([*spacing, 1])
    to_world[:3, 3] = spacing / 2 - 1
    return to_world


def voxel_centres(size: Size, to_world: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return x, y and z of the voxels' centres in the world, which broadcast to (nz, ny, nx)."""
    x, y, z = (to_world[i, i] * np.arange(n) + to_world[i, 3] for i, n in enumerate(size))
    return x, y[:, None], z[:, None, None]
