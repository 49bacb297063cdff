"""A camera at a light, fitted to points: perspective, or orthographic for a directional light.

For a light (q, w) in homogeneous coordinates about the middle of the points p, the rays are w p - q
with any w: w > 0 for a light at a place, 0 for one far away, and w < 0 behind an eye
[Ergun 2008, 2.2.2].
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


def enclose_body(light: Light, body: Body) -> Projection:
    """Return the projection from a light whose cube encloses a body.

    Raises `BrdfkitError` for a point light that the body surrounds.
    """
    view = view_matrix(light.point, body.corners, body.centroid)
    return fit_to_corners(view, light, body.corners)


def fit_to_corners(matrix: FloatArray, light: Light, corners: FloatArray) -> Projection:
    """Return the projection by a matrix (4, 4) through the light, stretched to enclose `corners`.

    Its cube just encloses the corners (n, 3).
    """
    ends = project_points(matrix, corners)
    to_cube = make_unit_cube_matrix(ends.min(axis=0), ends.max(axis=0))
    return Projection.from_matrix(to_cube @ matrix, light)


def view_matrix(light: FloatArray, corners: FloatArray, middle: FloatArray) -> FloatArray:
    """Return the matrix (4, 4) of a camera at the point `light` (4,), looking at `corners` (n, 3).

    x and y are of one scale, tangents or lengths, at right angles to the ray to the `middle` (3,),
    a point among the corners; depth is from -1 to 1 for the corners.

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
            "the light is among what it shadows: one map cannot look all around; use "
            "partition='cube' or shadow volumes, or move the light out of the scene's box."
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
    """Return the axis (3,) of the narrowest cone that holds `rays` (n, 3); 0 if there is none."""
    from scipy.optimize import nnls

    lengths = np.linalg.norm(rays, axis=1, keepdims=True)
    if lengths.min() < 1e-9 * lengths.max():
        return np.zeros(3)
    # The axis points to the point of the directions' convex hull that is nearest to 0
    units = rays / lengths
    weights, _ = nnls(np.vstack([units.T, np.ones(len(units))]), np.array([0, 0, 0, 1.0]))
    axis: FloatArray = weights @ units
    return axis / max(float(np.linalg.norm(axis)), 1e-9)
