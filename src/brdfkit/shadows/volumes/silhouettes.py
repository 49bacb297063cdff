"""The silhouettes of a mesh in a light: the edges that bound its casting triangles.

Both functions return the same edges (k, 2), and (k,) how often each of them bounds the casting
triangles, by the whole numbers that `casters.py` gives to triangles. An edge has the direction in
which the triangles run along it.

edge_toggling  The edges of all casting triangles are added up; an edge cancels if a second triangle
               runs back along it. For every mesh.
shared_edges   An edge belongs to the silhouette if its two triangles differ in their number. The
               edges are listed once for all lights. For closed meshes.

[Ergun 2008, 2.1.5]
"""

import numpy as np

from brdfkit.core.array_types import IntArray
from brdfkit.shadows.volumes.mesh import Mesh, list_directed_edges


def find_silhouette_by_toggling(mesh: Mesh, casts: IntArray) -> tuple[IntArray, IntArray]:
    """Return the silhouette of a mesh's casting triangles by adding up their directed edges.

    casts : the casting number (m,) of each triangle, see `casters.py`.
    """
    casting = casts != 0
    first, last, triangle = list_directed_edges(mesh.triangles[casting])
    low, high = np.minimum(first, last), np.maximum(first, last)
    signs = np.where(first < last, 1, -1) * casts[casting][triangle]
    key, place = np.unique(low * len(mesh.points) + high, return_inverse=True)
    edges = np.column_stack(np.divmod(key, len(mesh.points)))
    return orient_edges(edges, np.bincount(place, signs, len(key)).astype(int))


def find_silhouette_by_neighbours(mesh: Mesh, casts: IntArray) -> tuple[IntArray, IntArray]:
    """Return the silhouette of a mesh's casting triangles by comparing neighbouring triangles.

    casts : the casting number (m,) of each triangle, see `casters.py`.

    Raises `BrdfkitError` for an open mesh.
    """
    edges, forwards, backwards = mesh.shared_edges
    return orient_edges(edges, casts[forwards] - casts[backwards])


SILHOUETTES = {
    "edge_toggling": find_silhouette_by_toggling,
    "shared_edges": find_silhouette_by_neighbours,
}


def orient_edges(edges: IntArray, times: IntArray) -> tuple[IntArray, IntArray]:
    """Return the edges that count other than 0 times, turned over where the count is negative.

    times : how often each edge counts, (k,).
    """
    edges, times = edges[times != 0], times[times != 0]
    return np.where((times < 0)[:, None], edges[:, ::-1], edges), np.abs(times)
