"""A ball of triangles with texture coordinates and tangents, for files that bring an object."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray

ROWS, COLUMNS = 24, 48  # of faces, from pole to pole and around


@dataclass(frozen=True)
class BallMesh:
    """A ball of the radius 1 with y up, so that its `points` (n, 3) are its normals.

    `tangents` (n, 3): unit vectors along u; `uv` (n, 2): from 0 to 1 around y, and from the south
    pole to the north pole; `triangles` (m, 3): indices, counter-clockwise from outside.
    """

    points: FloatArray
    tangents: FloatArray
    uv: FloatArray
    triangles: Any


def make_ball() -> BallMesh:
    """Return the ball. At the seam and at the poles points are doubled, one for each u."""
    u, v = np.meshgrid(np.arange(COLUMNS + 1) / COLUMNS, np.arange(ROWS + 1) / ROWS)
    u[[0, -1]] += 0.5 / COLUMNS  # the middle of the triangle that ends at the pole
    phi, theta = 2 * np.pi * u, np.pi * v  # theta from the south pole
    points = np.stack([-np.sin(theta) * np.cos(phi), -np.cos(theta), np.sin(theta) * np.sin(phi)])
    tangents = np.stack([np.sin(phi), 0 * phi, np.cos(phi)])
    index = np.arange(u.size).reshape(u.shape)
    a, b, c, d = index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]
    lower, upper = np.stack([a, c, d], axis=2), np.stack([a, b, c], axis=2)
    corners = np.concatenate([lower[:-1].reshape(-1, 3), upper[1:].reshape(-1, 3)])
    used, triangles = np.unique(corners, return_inverse=True)
    arrays = points, tangents, np.stack([u, v])
    points, tangents, uv = (array.reshape(-1, u.size).T[used] for array in arrays)
    return BallMesh(points, tangents, uv, triangles.reshape(-1, 3))
