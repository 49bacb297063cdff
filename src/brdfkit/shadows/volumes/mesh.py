"""A shape as the triangles that bound its shadow, with the edges that they share."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.shadows.volumes.tessellation import tessellated


@dataclass(frozen=True)
class Mesh:
    """Triangles by the numbers (m, 3) of their corners, which are `points` (n, 3).

    No two points are at one place: a seam of texture coordinates does not part the triangles.
    """

    name: str
    points: np.ndarray
    triangles: np.ndarray

    @classmethod
    def of(cls, name, points, triangles):
        """Of any `points`; those at one place become one."""
        points, number = np.unique(points, axis=0, return_inverse=True)
        return cls(name, points, number.ravel()[triangles])

    @classmethod
    def of_shape(cls, shape):
        """Of one of Mitsuba's; `BrdfkitError` for one that neither has triangles nor gets any."""
        if not shape.is_mesh():
            return cls.of(shape.id(), *tessellated(shape))
        points = np.array(shape.vertex_positions_buffer(), float).reshape(-1, 3)
        triangles = np.array(shape.faces_buffer(), int).reshape(-1, 3)
        if not np.isfinite(points[triangles]).all():
            raise BrdfkitError(
                f"{shape.id()}: the mesh has a triangle whose corners are not all finite, which "
                "has no shadow volume; mend or remove it."
            )
        return cls.of(shape.id(), points, triangles)

    @cached_property
    def normals(self):
        """The normals (m, 3) of the triangles, as long as twice their areas."""
        a, b, c = self.points[self.triangles].transpose(1, 0, 2)
        return np.cross(b - a, c - a)

    @cached_property
    def shared_edges(self):
        """The edges (k, 2) and, of each, the triangle that has it forwards, and backwards.

        Two sweeps: edges whose first number is the smaller, then the others, which must be the same
        ones. Raises `BrdfkitError` where they are not: the mesh is open, or turned both ways.
        """
        first, last, triangle = directed_edges(self.triangles)
        key = np.minimum(first, last) * len(self.points) + np.maximum(first, last)
        forwards, backwards = (sweep[np.argsort(key[sweep])] for sweep in sweeps(first < last))
        if not (
            np.array_equal(key[forwards], key[backwards])
            and len(np.unique(key[forwards])) == len(forwards)
        ):
            raise BrdfkitError(
                f"{self.name}: the mesh is not closed: not every edge is shared by two triangles "
                "that are turned the same way; close it, or use casters = all and "
                "silhouettes = edge_toggling."
            )
        edges = np.column_stack([first, last])[forwards]
        return edges, triangle[forwards], triangle[backwards]


def directed_edges(triangles):
    """The edges of triangles (m, 3), in their turn: first and last numbers, and whose (3m,)."""
    first = triangles.ravel()
    last = triangles[:, [1, 2, 0]].ravel()
    return first, last, np.repeat(np.arange(len(triangles)), 3)


def sweeps(mask):
    """The indices where a mask holds, and where not."""
    return np.flatnonzero(mask), np.flatnonzero(~mask)
