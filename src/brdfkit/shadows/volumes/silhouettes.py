"""Finds the silhouette of a mesh in a light: the edges that bound the triangles that cast shadows.

Two ways give the same result: the edges as pairs of vertex indices (k, 2), and how often each of
them counts (k,). An edge has the direction in which the corners of its casting triangles follow
each other. A triangle's casting number, from `casters.py`, is 1, -1 (turned over) or 0.

edge_toggling  Adds up the directed edges of all casting triangles; an edge cancels if a second
               triangle runs back along it. This suits every mesh.
shared_edges   Finds the edges whose two triangles have different casting numbers. The list of edges
               is the same for all lights, but the mesh must be closed.

[Ergun 2008, 2.1.5]
"""

import numpy as np

from brdfkit.core.array_types import IntArray
from brdfkit.shadows.volumes.mesh import Mesh, list_directed_edges


def find_silhouette_by_toggling(mesh: Mesh, casts: IntArray) -> tuple[IntArray, IntArray]:
    """Return the silhouette of a mesh's casting triangles by adding up their directed edges.

    The result is the edges (k, 2), and how often each of them counts (k,).

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

    The result is the edges (k, 2), and how often each of them counts (k,).

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
    """Make all counts of edges positive: turn edges with a negative count over, and drop zeros.

    edges : pairs of vertex indices (k, 2).
    times : how often each edge counts, (k,).
    """
    edges, times = edges[times != 0], times[times != 0]
    return np.where((times < 0)[:, None], edges[:, ::-1], edges), np.abs(times)
