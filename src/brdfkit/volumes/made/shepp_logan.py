"""The Shepp-Logan head phantom in three dimensions: ten ellipsoids on [-1, 1]³ whose values add up.

The cross-sections through the ellipsoids' centres are ellipses of the two-dimensional phantom
[Shepp & Logan 1974]. The half axes and centres along z are from M. Schabel's phantom3d, the values
from [Toft 1996], whose contrast makes the inner parts visible: a skull of 1, a brain of 0.2. An
ellipsoid has a value, half axes a, b, c and a centre, and is turned by φ about z.
"""

import numpy as np

from brdfkit.volumes.made._cube_grid import Size, make_cube_transform, voxel_centres
from brdfkit.volumes.volume import Volume

SIZE = 64
BYTES = 14  # memory per voxel that `make` needs
ELLIPSOIDS = (  # value; half axes a, b, c; centre x, y, z; turn φ about z [degrees]
    (1.0, 0.69, 0.92, 0.81, 0.0, 0.0, 0.0, 0),
    (-0.8, 0.6624, 0.874, 0.78, 0.0, -0.0184, 0.0, 0),
    (-0.2, 0.11, 0.31, 0.22, 0.22, 0.0, 0.0, -18),
    (-0.2, 0.16, 0.41, 0.28, -0.22, 0.0, 0.0, 18),
    (0.1, 0.21, 0.25, 0.41, 0.0, 0.35, -0.15, 0),
    (0.1, 0.046, 0.046, 0.05, 0.0, 0.1, 0.25, 0),
    (0.1, 0.046, 0.046, 0.05, 0.0, -0.1, 0.25, 0),
    (0.1, 0.046, 0.023, 0.05, -0.08, -0.605, 0.0, 0),
    (0.1, 0.023, 0.023, 0.02, 0.0, -0.606, 0.0, 0),
    (0.1, 0.023, 0.046, 0.02, 0.06, -0.605, 0.0, 0),
)


def make(size: Size) -> Volume:
    """Make the volume of the Shepp-Logan phantom, with `size` (nx, ny, nz) voxels."""
    to_world = make_cube_transform(size)
    x, y, z = voxel_centres(size, to_world)
    values = np.zeros(size[::-1], np.float32)
    for value, a, b, c, x0, y0, z0, degrees in ELLIPSOIDS:
        cos, sin = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
        along = (x - x0) * cos + (y - y0) * sin
        across = (y - y0) * cos - (x - x0) * sin
        values += value * ((along / a) ** 2 + (across / b) ** 2 + ((z - z0) / c) ** 2 <= 1)
    return Volume(values, to_world, "shepp_logan")
