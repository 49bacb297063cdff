"""The silhouettes of a mesh in a light: the edges that bound the triangles which cast the shadow.

Both ways give the same edges (k, 2) and how often each bounds them (k,), by the numbers that
`casters.py` gives to the triangles; an edge is directed as the triangles run along it.

edge_toggling : an edge comes in with the first of the casting triangles and goes out with a second
    that runs back along it. For every mesh.
shared_edges : of each edge that two triangles share, whether they differ. The edges are listed once
    for all lights; for closed meshes.

[Ergun 2008, 2.1.5]
"""

import numpy as np

from brdfkit.shadows.volumes.mesh import directed_edges


def edge_toggling(mesh, casts):
    casting = casts != 0
    first, last, triangle = directed_edges(mesh.triangles[casting])
    low, high = np.minimum(first, last), np.maximum(first, last)
    way = np.where(first < last, 1, -1) * casts[casting][triangle]
    key, place = np.unique(low * len(mesh.points) + high, return_inverse=True)
    edges = np.column_stack(np.divmod(key, len(mesh.points)))
    return directed(edges, np.bincount(place, way, len(key)).astype(int))


def shared_edges(mesh, casts):
    edges, forwards, backwards = mesh.shared_edges
    return directed(edges, casts[forwards] - casts[backwards])


SILHOUETTES = {"edge_toggling": edge_toggling, "shared_edges": shared_edges}


def directed(edges, times):
    """The edges that bound at all, turned so that each does so once or more."""
    edges, times = edges[times != 0], times[times != 0]
    return np.where((times < 0)[:, None], edges[:, ::-1], edges), np.abs(times)
