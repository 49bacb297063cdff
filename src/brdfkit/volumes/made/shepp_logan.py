"""The Shepp-Logan head phantom in three dimensions: ten ellipsoids, whose values add up.

On [-1, 1]³. Where an ellipsoid cuts the plane of its centre lies an ellipse of the phantom in two
dimensions [Shepp & Logan 1974]; half axes and places along z are those of M. Schabel's phantom3d,
the contrasts those of [Toft 1996], by which the inner parts are seen: a skull of 1, a brain of 0.2.
An ellipsoid has a value, half axes a, b, c, a centre, and is turned by φ about z.
"""

import numpy as np

from brdfkit.volumes.made._grid import centres, filling_cube
from brdfkit.volumes.volume import Volume

SIZE = 64
BYTES = 14  # that a voxel takes while it is made
ELLIPSOIDS = (  # value, a, b, c, x, y, z, φ [degrees]
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


def make(size):
    """The phantom at the centres of the voxels."""
    to_world = filling_cube(size, 1.0)
    x, y, z = centres(size, to_world)
    values = np.zeros(size[::-1], np.float32)
    for value, a, b, c, x0, y0, z0, degrees in ELLIPSOIDS:
        cos, sin = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
        along = (x - x0) * cos + (y - y0) * sin
        across = (y - y0) * cos - (x - x0) * sin
        values += value * ((along / a) ** 2 + (across / b) ** 2 + ((z - z0) / c) ** 2 <= 1)
    return Volume(values, to_world, "shepp_logan")


def total():
    """The integral of the phantom over its box: of the ellipsoids, which lie within it."""
    return sum(v * 4 / 3 * np.pi * a * b * c for v, a, b, c, *_ in ELLIPSOIDS)
