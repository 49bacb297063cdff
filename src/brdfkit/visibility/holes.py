"""Closes the small holes of a mesh, as scans have them: each by a fan of triangles."""

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

WIDEST = 0.3  # of a hole over the longest side of the mesh; a wider one is an opening


def close_holes(points, faces):
    """The welded mesh with its holes closed, each from the mean of its corners.

    It comes back as it is where it has an opening or several pieces, which may cross each other, or
    where the edges at its holes are no plain loops.
    """
    loops = _loops(faces)
    size = np.ptp(points, axis=0).max()
    if not loops or _pieces(faces) > 1:
        return points, faces
    if max(np.ptp(points[loop], axis=0).max() for loop in loops) > WIDEST * size:
        return points, faces
    middles = [points[loop].mean(axis=0) for loop in loops]
    fans = [
        [a, b, len(points) + k]
        for k, loop in enumerate(loops)
        for a, b in zip(loop, loop[1:] + loop[:1], strict=True)
    ]
    return np.concatenate([points, middles]), np.concatenate([faces, fans])


def _loops(faces):
    """The corners around each hole, lists in the order of the triangles that close it.

    Empty where the mesh is closed, or two holes share a corner.
    """
    edges = set(map(tuple, np.concatenate([faces[:, [i, (i + 1) % 3]] for i in range(3)]).tolist()))
    border = [(b, a) for a, b in edges if (b, a) not in edges]
    following = dict(border)
    if len(following) < len(border):
        return []
    loops = []
    while following:
        first, corner = following.popitem()
        loop = [first]
        while corner != first:
            loop.append(corner)
            if corner not in following:
                return []
            corner = following.pop(corner)
        loops.append(loop)
    return loops


def _pieces(faces):
    """Into how many pieces without a common vertex the triangles fall."""
    _, numbers = np.unique(faces, return_inverse=True)
    a, b, c = numbers.reshape(-1, 3).T
    links = np.concatenate([a, b]), np.concatenate([b, c])
    n = numbers.max() + 1
    return connected_components(coo_array((np.ones(len(links[0])), links), shape=(n, n)))[0]
