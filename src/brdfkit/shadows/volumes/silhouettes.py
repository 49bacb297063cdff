"""The silhouettes of a mesh in a light: the edges that bound its casting triangles.

Both functions return the same edges (k, 2) and how often each bounds the casting triangles (k,), by
the whole numbers that `casters.py` gives to triangles. An edge has the direction in which the
triangles run along it.

edge_toggling  An edge comes in with the first casting triangle and goes out with a second one that
               runs back along it. For every mesh.
shared_edges   An edge that two triangles share belongs to the silhouette if they differ. The edges
               are listed once for all lights; for closed meshes.

[Ergun 2008, 2.1.5]
"""

import numpy as np

from brdfkit.core.array_types import IntArray
from brdfkit.shadows.volumes.mesh import Mesh, directed_edges


def toggle_edges(mesh: Mesh, casts: IntArray) -> tuple[IntArray, IntArray]:
    """Return the silhouette of the triangles that `casts` (m,) marks, by adding up their edges."""
    casting = casts != 0
    first, last, triangle = directed_edges(mesh.triangles[casting])
    low, high = np.minimum(first, last), np.maximum(first, last)
    signs = np.where(first < last, 1, -1) * casts[casting][triangle]
    key, place = np.unique(low * len(mesh.points) + high, return_inverse=True)
    edges = np.column_stack(np.divmod(key, len(mesh.points)))
    return orient_edges(edges, np.bincount(place, signs, len(key)).astype(int))


def compare_neighbours(mesh: Mesh, casts: IntArray) -> tuple[IntArray, IntArray]:
    """Return the silhouette of the triangles that `casts` (m,) marks, from neighbours' differences.

    Raises `BrdfkitError` for an open mesh.
    """
    edges, forwards, backwards = mesh.shared_edges
    return orient_edges(edges, casts[forwards] - casts[backwards])


SILHOUETTES = {"edge_toggling": toggle_edges, "shared_edges": compare_neighbours}


def orient_edges(edges: IntArray, times: IntArray) -> tuple[IntArray, IntArray]:
    """Return the edges with `times` (k,) other than 0, turned over where it is negative."""
    edges, times = edges[times != 0], times[times != 0]
    return np.where((times < 0)[:, None], edges[:, ::-1], edges), np.abs(times)
