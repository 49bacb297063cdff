"""Transforms points by 4 × 4 matrices, in NumPy or Dr.Jit; vectors are columns.

The components of points are arguments and results of their own: floats, NumPy arrays or Dr.Jit
arrays. A `matrix` is an array (4, 4) or a `mi.Matrix4f`.
"""

from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray, ArrayLike, FloatArray, JitFloat


def transform(
    matrix: Any, x: JitFloat, y: JitFloat, z: JitFloat, w: JitFloat = 1.0
) -> tuple[Any, ...]:
    """Return the homogeneous coordinates (x, y, z, w) of a point after a transformation.

    >>> np.array(transform(np.diag([2, 1, 1, 1]), 1.0, 2.0, 3.0))
    array([2., 2., 3., 1.])
    """
    return tuple(
        matrix[row, 0] * x + matrix[row, 1] * y + matrix[row, 2] * z + matrix[row, 3] * w
        for row in range(4)
    )


def project(
    matrix: Any, x: JitFloat, y: JitFloat, z: JitFloat
) -> tuple[JitFloat, JitFloat, JitFloat]:
    """Transform a point by a projective matrix, and divide by w; return (x, y, z)."""
    x, y, z, w = transform(matrix, x, y, z)
    return x / w, y / w, z / w


def normalise(x: JitFloat, y: JitFloat, z: JitFloat) -> tuple[JitFloat, JitFloat, JitFloat]:
    """Return the unit vector along (x, y, z)."""
    length = (x * x + y * y + z * z) ** 0.5
    return x / length, y / length, z / length


def project_points(matrix: AnyArray, points: ArrayLike) -> AnyArray:
    """Transform points (n, 3) by a projective matrix (4, 4), and divide them by w."""
    return np.column_stack(project(matrix, *np.asarray(points, float).T))


def make_rigid_matrix(rotation: ArrayLike, origin: ArrayLike) -> FloatArray:
    """Return the matrix (4, 4) to the frame at `origin` whose axes are the rows of `rotation`."""
    matrix = np.eye(4)
    matrix[:3, :3] = rotation
    matrix[:3, 3] = -np.asarray(rotation) @ origin
    return matrix


def make_unit_cube_matrix(low: ArrayLike, high: ArrayLike) -> FloatArray:
    """Return the matrix (4, 4) that maps the box from `low` (3,) to `high` (3,) onto [-1, 1]³.

    >>> np.array(project(make_unit_cube_matrix([0, 0, 0], [1, 2, 4]), 1.0, 1.0, 0.0))
    array([ 1.,  0., -1.])
    """
    low, high = np.asarray(low, float), np.asarray(high, float)
    size = high - low
    matrix = np.diag([*(2 / size), 1.0])
    matrix[:3, 3] = -(high + low) / size
    return matrix


def make_axes(z: FloatArray, hint: ArrayLike | None = None) -> FloatArray:
    """Return right-handed unit vectors x, y, z as rows (3, 3), for a unit vector z.

    y is as near as possible to `hint`, or to an axis where `hint` is missing or parallel to z.
    """
    upwards = np.zeros(3) if hint is None else np.asarray(hint, float)
    if np.linalg.norm(np.cross(z, upwards)) < 1e-6:
        upwards = np.eye(3)[np.argmin(np.abs(z))]
    x = np.cross(upwards, z)
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(z, x), z])
