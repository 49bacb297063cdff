"""A knotted tube, with shadows on itself and light between its turns."""

import numpy as np

from brdfkit.rendering.scenes._meshes import mesh_of_grid
from brdfkit.rendering.scenes._studio import studio

TUBE = 0.235  # radius
LEAN = 0.3  # of the knot, away from the camera [radians]
ROWS, AROUND = 512, 64  # along the tube, around it


def knot(bsdf, size=(512, 512)):
    """The scene's dictionary; see `brdfkit.rendering.scenes`.

    The tube is brushed around its axis, as a turned rod.

    >>> knot({"type": "diffuse"})["knot"].class_name()    # doctest: +SKIP
    'Mesh'
    """
    return studio(size) | {"knot": mesh_of_grid(*tube(), bsdf)}


def tube():
    """(points, normals) of the tube, which stands on the ground; a grid for a mesh.

    Its axis is the trefoil, the torus knot of two turns about the axis y and three through the
    hole. u runs around the tube, v along it.
    """
    t = np.linspace(0, 2 * np.pi, ROWS + 1)[:, None]
    wide = 2 + np.cos(3 * t)
    axis = 0.3 * np.hstack([wide * np.sin(2 * t), 1.2 * np.sin(3 * t), wide * np.cos(2 * t)])
    axis = _lean(axis)

    # two directions across the axis: away from the middle, as far as it is across, and the third
    along = np.gradient(axis, axis=0)
    along[[0, -1]] = axis[1] - axis[-2]  # it closes
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    side = axis - np.sum(axis * along, axis=1, keepdims=True) * along
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    other = np.cross(along, side)

    phi = np.linspace(0, 2 * np.pi, AROUND + 1)[:, None]
    normals = np.cos(phi) * side[:, None] + np.sin(phi) * other[:, None]
    points = axis[:, None] + TUBE * normals
    return points - (0, 0, points[..., 2].min()), normals


def _lean(points):
    """The points turned about the axis x, backwards at the top."""
    cos, sin = np.cos(LEAN), np.sin(LEAN)
    return points @ np.array([[1, 0, 0], [0, cos, -sin], [0, sin, cos]])
