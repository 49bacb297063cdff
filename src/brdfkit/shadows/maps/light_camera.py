"""A camera at a light, fitted to points: perspective, or orthographic for a directional light.

One formula serves all lights: the light is a homogeneous point (q, w), relative to the middle of
the points p, and its rays have the directions w p - q [Ergun 2008, 2.2.2]. w > 0 for a point or
spot light, w = 0 for a directional light, and w < 0 if a projection has put the light behind the
eye.
"""

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.projective.body import Body
from brdfkit.core.projective.homogeneous import (
    make_axes,
    make_rigid_matrix,
    make_unit_cube_matrix,
    project_points,
)
from brdfkit.core.projective.light import NEAREST, Light
from brdfkit.shadows.maps.projection import Projection


def make_enclosing_projection(light: Light, body: Body) -> Projection:
    """Return the projection of a light's shadow map that just encloses a body.

    Raises `BrdfkitError` for a point or spot light that the body surrounds.
    """
    view = view_matrix(light.point, body.corners, body.centroid)
    return fit_projection(view, light, body.corners)


def fit_projection(matrix: FloatArray, light: Light, corners: FloatArray) -> Projection:
    """Return the projection by a matrix, scaled so that the map and its depths just enclose points.

    matrix : (4, 4), from the world to map coordinates and depth of any scale.
    corners : the points (n, 3) in the world.
    """
    ends = project_points(matrix, corners)
    to_cube = make_unit_cube_matrix(ends.min(axis=0), ends.max(axis=0))
    return Projection.from_matrix(to_cube @ matrix, light)


def view_matrix(light: FloatArray, corners: FloatArray, middle: FloatArray) -> FloatArray:
    """Return the matrix (4, 4) of a camera at a light, from the world to map coordinates and depth.

    The camera looks at `middle`. Its coordinates x and y have the same scale: they are tangents or,
    for a light at infinity, lengths. The depths of `corners` become -1 to 1.

    light : homogeneous point (4,) of the light.
    corners : points (n, 3) that the camera must see.
    middle : a point (3,) among the corners.

    Raises `BrdfkitError` if no plane separates the light from the corners.
    """
    to_middle = make_rigid_matrix(np.eye(3), middle)
    *components, w = to_middle @ light
    q = np.array(components)
    rays = w * (corners - middle) - q
    axis = narrowest_cone_axis(rays)
    before = rays @ axis
    if not before.min() > NEAREST / 2 * before.max():
        raise BrdfkitError(
            "the light is inside the scene's box, and one shadow map cannot look all around; use "
            "partition='cube' or shadow volumes, or move the light out of the box."
        )
    matrix = np.zeros((4, 4))
    matrix[:3, :3] = make_axes(-q / np.linalg.norm(q))
    matrix[3] = [*(w * axis), -axis @ q]
    matrix = matrix @ to_middle
    depths = project_points(matrix, corners)[:, 2]
    low, high = depths.min(), depths.max()
    view: FloatArray = make_unit_cube_matrix([-1, -1, low], [1, 1, high]) @ matrix
    return view


def narrowest_cone_axis(rays: FloatArray) -> FloatArray:
    """Return the axis (3,) of the narrowest cone around `rays` (n, 3), a unit vector.

    It is 0 if no cone encloses the rays, as they lead in all directions.
    """
    from scipy.optimize import nnls

    lengths = np.linalg.norm(rays, axis=1, keepdims=True)
    if lengths.min() < 1e-9 * lengths.max():
        return np.zeros(3)
    # The axis leads from the origin to the nearest point of the convex hull of the unit vectors
    units = rays / lengths
    weights, _ = nnls(np.vstack([units.T, np.ones(len(units))]), np.array([0, 0, 0, 1.0]))
    axis: FloatArray = weights @ units
    return axis / max(float(np.linalg.norm(axis)), 1e-9)
