"""A camera at a light, fitted to points: orthographic for one far away, else perspective."""

import numpy as np

from brdfkit.errors import BrdfkitError
from brdfkit.projective.homogeneous import (
    axes_about,
    project_all,
    rigid,
    to_unit_cube,
    transform,
)
from brdfkit.projective.light import NEAREST
from brdfkit.shadow_maps.projection import Projection


def around(light, corners):
    """The `Projection` whose cube encloses the `corners` (n, 3) of a body.

    Raises `BrdfkitError` for a point light that the body surrounds.
    """
    view = frame(light, corners)
    matrix = view if light.is_directional else one_apex(view, corners) @ view
    ends = project_all(matrix, corners)
    low, high = ends.min(axis=0), ends.max(axis=0)
    return Projection.by(to_unit_cube(low, high) @ matrix, light)


def frame(light, corners):
    """The matrix (4, 4) into a frame at the light that looks along z at the middle of `corners`."""
    middle = corners.mean(axis=0)
    if light.is_directional:
        origin, z = middle, -light.point[:3]
    else:
        origin = light.point[:3]
        z = middle - origin if light.axis is None else light.axis
        z = z / np.linalg.norm(z)
    return rigid(axes_about(z), origin)


def one_apex(view, corners):
    """The perspective matrix (4, 4) of a camera along z whose planes enclose `corners`.

    Raises `BrdfkitError` where corners are behind it.
    """
    z = transform(view, *np.asarray(corners).T)[2]
    n, f = z.min(), z.max()
    if n < NEAREST * f / 2 or f <= 0:
        raise BrdfkitError(
            "the light is among what it shadows: one map cannot look all around; use a spot light, "
            "or move the light out of the scene's box."
        )
    matrix = np.diag([1.0, 1.0, (f + n) / (f - n), 0])
    matrix[2, 3], matrix[3, 2] = -2 * f * n / (f - n), 1
    return matrix
