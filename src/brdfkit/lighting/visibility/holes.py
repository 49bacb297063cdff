"""Closing of holes in a piece of a mesh by fans of triangles, except for intended openings."""

import numpy as np

from brdfkit.core.array_types import FloatArray, IntArray

WIDE_HOLE = 0.3  # a hole wider than this share of the mesh's longest side may be an opening
COVERED = 0.75  # smallest winding number in the middle of a hole that the mesh surrounds


def close_holes(points: FloatArray, faces: IntArray, mesh: IntArray) -> tuple[FloatArray, IntArray]:
    """Close the holes of a piece of a mesh, each by triangles from the mean of its corners.

    Returns the points and faces of the piece, all of whose triangles `faces` have to face out.
    `mesh` (m, 3) are the faces of all pieces, with the same points. A wide hole is closed only if
    other pieces cover it, as the body of a teapot covers the foot of its spout: the winding number
    [Jacobson et al. 2013] in its middle is then 1, but 1/2 at an opening. A piece is returned
    unchanged if it has an opening, or if two of its holes share a corner.
    """
    loops = _find_hole_loops(faces)
    if not loops:
        return points, faces
    middles = np.array([points[loop].mean(axis=0) for loop in loops])
    size = np.ptp(points[mesh], axis=(0, 1)).max()
    wide = np.array([np.ptp(points[loop], axis=0).max() > WIDE_HOLE * size for loop in loops])
    if wide.any() and _winding_number(points, mesh, middles[wide]).min() < COVERED:
        return points, faces
    fans = [
        [a, b, len(points) + k]
        for k, loop in enumerate(loops)
        for a, b in zip(loop, loop[1:] + loop[:1], strict=True)
    ]
    return np.concatenate([points, middles]), np.concatenate([faces, fans])


def _winding_number(points: FloatArray, faces: IntArray, at: FloatArray) -> FloatArray:
    """Return the winding number (n,) of a mesh's `faces` around each of the points `at` (n, 3)."""
    import igl

    return igl.winding_number(points, faces, at)


def _find_hole_loops(faces: IntArray) -> list[list[int]]:
    """Return the numbers of the corners around each hole, in the order of triangles that close it.

    The list is empty if the piece is closed, or if two holes share a corner.
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
