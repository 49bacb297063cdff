"""A camera at a light, fitted to points: perspective, or orthographic where the light is far away.

Of a light l = (q, w) in homogeneous coordinates about the middle of the points p, the rays are
w p - q, for any w: a light at a place, far away, or behind an eye, where w < 0 [Ergun 2008, 2.2.2].
"""

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.projective.homogeneous import make_axes, make_rigid, project_all, to_unit_cube
from brdfkit.core.projective.light import NEAREST
from brdfkit.shadows.maps.projection import Projection


def around(light, body):
    """The `Projection` whose cube encloses a `Body`.

    Raises `BrdfkitError` for a point light that the body surrounds.
    """
    return fitted(view(light.point, body.corners, body.middle), light, body.corners)


def fitted(matrix, light, corners):
    """The `Projection` by a `matrix` (4, 4) through the light, then stretched so that its cube just
    encloses `corners` (n, 3)."""
    ends = project_all(matrix, corners)
    return Projection.by(to_unit_cube(ends.min(axis=0), ends.max(axis=0)) @ matrix, light)


def view(light, corners, middle):
    """The matrix (4, 4) of a camera at the point `light` (4,) that looks at `corners` (n, 3).

    x and y are of one scale, tangents or lengths, at right angles to the ray to the `middle` (3,),
    a point among the corners; depth is from -1 to 1 for the corners.

    Raises `BrdfkitError` where no plane parts the light from the corners.
    """
    to_middle = make_rigid(np.eye(3), middle)
    *q, w = to_middle @ light
    q = np.array(q)
    rays = w * (corners - middle) - q
    axis = axis_of(rays)
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
    depths = project_all(matrix, corners)[:, 2]
    low, high = depths.min(), depths.max()
    return to_unit_cube([-1, -1, low], [1, 1, high]) @ matrix


def axis_of(rays):
    """The axis (3,) of the narrowest cone that holds `rays` (n, 3); 0 where none holds them."""
    from scipy.optimize import nnls

    lengths = np.linalg.norm(rays, axis=1, keepdims=True)
    if lengths.min() < 1e-9 * lengths.max():
        return np.zeros(3)
    # towards the point of the convex hull of their directions that is nearest to 0
    units = rays / lengths
    weights, _ = nnls(np.vstack([units.T, np.ones(len(units))]), np.array([0, 0, 0, 1.0]))
    axis = weights @ units
    return axis / max(np.linalg.norm(axis), 1e-9)
