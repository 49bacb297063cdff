"""Points through 4 × 4 matrices, in NumPy or Dr.Jit; columns, so that matrices act from the left.

Components are arguments and results of their own: floats, NumPy arrays or Dr.Jit arrays, and
`matrix` is an array (4, 4) or a `mi.Matrix4f`.
"""

import numpy as np


def transform(matrix, x, y, z, w=1.0):
    """The homogeneous coordinates (x, y, z, w) of a point, transformed.

    >>> transform(np.diag([2, 1, 1, 1]), 1.0, 2.0, 3.0)
    (2.0, 2.0, 3.0, 1.0)
    """
    return tuple(
        matrix[row, 0] * x + matrix[row, 1] * y + matrix[row, 2] * z + matrix[row, 3] * w
        for row in range(4)
    )


def project(matrix, x, y, z):
    """The point (x, y, z), transformed and divided by w."""
    x, y, z, w = transform(matrix, x, y, z)
    return x / w, y / w, z / w


def normalise(x, y, z):
    """The vector (x, y, z), of length 1."""
    length = (x * x + y * y + z * z) ** 0.5
    return x / length, y / length, z / length


def project_all(matrix, points):
    """The points (n, 3), transformed and divided by w: (n, 3)."""
    return np.column_stack(project(matrix, *np.asarray(points, float).T))


def make_rigid(rotation, origin):
    """The matrix (4, 4) into a frame: `rotation` (3, 3) has its axes as rows."""
    matrix = np.eye(4)
    matrix[:3, :3] = rotation
    matrix[:3, 3] = -np.asarray(rotation) @ origin
    return matrix


def to_unit_cube(low, high):
    """The matrix (4, 4) that maps the box from `low` (3,) to `high` (3,) onto [-1, 1]³.

    >>> project(to_unit_cube([0, 0, 0], [1, 2, 4]), 1.0, 1.0, 0.0)
    (1.0, 0.0, -1.0)
    """
    low, high = np.asarray(low, float), np.asarray(high, float)
    size = high - low
    matrix = np.diag([*(2 / size), 1.0])
    matrix[:3, 3] = -(high + low) / size
    return matrix


def make_axes(z, hint=None):
    """Unit vectors x, y, z as rows (3, 3), right-handed; y is near `hint`, or else near an axis."""
    if hint is None or np.linalg.norm(np.cross(z, hint)) < 1e-6:
        hint = np.eye(3)[np.argmin(np.abs(z))]
    x = np.cross(hint, z)
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(z, x), z])
