"""The triangles of a shape that bound its shadow volume, and the edges that they share."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray, IntArray, MitsubaObject
from brdfkit.core.errors import BrdfkitError
from brdfkit.shadows.volumes.tessellation import tessellate_shape


@dataclass(frozen=True)
class Mesh:
    """The triangles of a shape, with welded vertices.

    Mesh files may repeat a vertex, for example along a seam of texture coordinates. Here each place
    has only one vertex, so that neighbouring triangles share their edges.

    name : the shape's name, for error messages.
    points : the vertices (n, 3).
    triangles : for each triangle the indices of its corners in `points`, (m, 3).
    """

    name: str
    points: AnyArray
    triangles: AnyArray

    @classmethod
    def weld(cls, name: str, points: AnyArray, triangles: AnyArray) -> "Mesh":
        """Return the mesh of points and triangles, with equal points merged to one vertex."""
        points, index = np.unique(points, axis=0, return_inverse=True)
        return cls(name, points, index.ravel()[triangles])

    @classmethod
    def from_shape(cls, shape: MitsubaObject) -> "Mesh":
        """Make a mesh of a Mitsuba shape; raise `BrdfkitError` if it cannot have triangles."""
        if not shape.is_mesh():
            return cls.weld(shape.id(), *tessellate_shape(shape))
        points = np.array(shape.vertex_positions_buffer(), float).reshape(-1, 3)
        triangles = np.array(shape.faces_buffer(), int).reshape(-1, 3)
        if not np.isfinite(points[triangles]).all():
            raise BrdfkitError(
                f"{shape.id()}: the mesh has a triangle whose corners are not all finite, which "
                "has no shadow volume; mend or remove it."
            )
        return cls.weld(shape.id(), points, triangles)

    @cached_property
    def normals(self) -> FloatArray:
        """The normals (m, 3) of the triangles; their lengths are twice the triangles' areas."""
        a, b, c = self.points[self.triangles].transpose(1, 0, 2)
        return np.cross(b - a, c - a)

    @cached_property
    def shared_edges(self) -> tuple[IntArray, IntArray, IntArray]:
        """The edges, and for each edge its two triangles: (k, 2), (k,) and (k,) indices.

        An edge has its smaller vertex index first; the corners of the first triangle run along the
        edge in this direction, those of the second run back. Raises `BrdfkitError` for meshes that
        are open, or whose triangles are not all oriented alike.
        """
        first, last, triangle = list_directed_edges(self.triangles)
        key = np.minimum(first, last) * len(self.points) + np.maximum(first, last)
        sides = np.flatnonzero(first < last), np.flatnonzero(first >= last)
        forwards, backwards = (side[np.argsort(key[side])] for side in sides)
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


def list_directed_edges(triangles: IntArray) -> tuple[IntArray, IntArray, IntArray]:
    """List the three edges of each of the triangles (m, 3).

    Return the indices of each edge's first vertex, last vertex and triangle, (3m,) each.
    """
    first = triangles.ravel()
    last = triangles[:, [1, 2, 0]].ravel()
    return first, last, np.repeat(np.arange(len(triangles)), 3)
