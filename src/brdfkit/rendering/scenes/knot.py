"""A knotted tube, which casts shadows on itself and reflects light between its turns."""

from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray, MitsubaObject
from brdfkit.rendering.scenes._meshes import make_grid_mesh
from brdfkit.rendering.scenes._studio import make_studio

TUBE = 0.235  # radius of the tube [m]
LEAN = 0.3  # angle by which the knot leans away from the camera [radians]
ROWS, AROUND = 512, 64  # numbers of points along the tube and around it


def knot(
    bsdf: dict[str, Any] | MitsubaObject, size: tuple[int, int] = (512, 512)
) -> dict[str, Any]:
    """Return the dictionary of a scene that shows the material `bsdf` on a knotted tube.

    An anisotropic material is brushed around the tube, as a turned rod is.

    >>> knot({"type": "diffuse"})["knot"].class_name()    # doctest: +SKIP
    'Mesh'
    """
    return make_studio(size) | {"knot": make_grid_mesh(*make_knot_tube(), bsdf)}


def make_knot_tube() -> tuple[FloatArray, FloatArray]:
    """Return a grid of points (rows, columns, 3) and normals of a knotted tube on the ground.

    The tube's axis is the trefoil, the torus knot with two turns about the axis y and three through
    the hole. u runs around the tube, v along it.
    """
    t = np.linspace(0, 2 * np.pi, ROWS + 1)[:, None]
    wide = 2 + np.cos(3 * t)
    axis: FloatArray = 0.3 * np.hstack(
        [wide * np.sin(2 * t), 1.2 * np.sin(3 * t), wide * np.cos(2 * t)]
    )
    cos, sin = np.cos(LEAN), np.sin(LEAN)
    axis = axis @ np.array([[1, 0, 0], [0, cos, -sin], [0, sin, cos]])

    # `side` and `other` are directions across the tube; `side` leads away from the knot's middle
    along = np.gradient(axis, axis=0)
    along[[0, -1]] = axis[1] - axis[-2]  # as the curve is closed, its ends are neighbours
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    side = axis - np.sum(axis * along, axis=1, keepdims=True) * along
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    other = np.cross(along, side)

    phi = np.linspace(0, 2 * np.pi, AROUND + 1)[:, None]
    normals = np.cos(phi) * side[:, None] + np.sin(phi) * other[:, None]
    points = axis[:, None] + TUBE * normals
    return points - (0, 0, points[..., 2].min()), normals
