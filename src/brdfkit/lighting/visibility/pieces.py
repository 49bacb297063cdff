"""Splitting of a mesh into its connected pieces, which are turned outwards and closed.

A modelled object often consists of several surfaces that intersect each other: the spout of a
teapot ends within its body. coacd cannot cut them as one mesh, nor a mesh with triangles that face
inwards: it makes a thousand splinters, or does not end within minutes.
"""

import numpy as np

from brdfkit.core.array_types import FloatArray, IntArray
from brdfkit.core.errors import BrdfkitError

WIDE_HOLE = 0.3  # a hole wider than this share of the mesh's longest side may be an opening
# a hole is covered by other pieces if its middle has a winding number of at least this
COVERED = 0.75


def split_solids(
    points: FloatArray, faces: IntArray
) -> tuple[list[tuple[FloatArray, IntArray]], IntArray]:
    """Split a welded mesh into its closed pieces, and the faces of the pieces that are not closed.

    A closed piece is (points, faces). The triangles of a piece are connected by shared edges, and
    are turned so that all face out; its holes are closed. The wall of a cavity within a solid is a
    piece of its own, so that the cavity counts as filled; no light enters it from outside. Raises
    `BrdfkitError` if libigl is not installed.
    """
    faces, piece = _orient_outwards(points, faces)
    closed, others = [], []
    for number in range(piece.max() + 1):
        mine = faces[piece == number]
        mended = _close_holes(points, mine, faces)
        if is_closed(mended[1]):
            closed.append(_drop_unused_points(*mended))
        else:
            others.append(mine)
    return closed, np.concatenate(others) if others else np.empty((0, 3), int)


def is_closed(faces: IntArray) -> bool:
    """Return whether a welded mesh is closed: every edge of its `faces` (m, 3) belongs to two."""
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    _, count = np.unique(edges, axis=0, return_counts=True)
    return bool(np.all(count == 2))


def _orient_outwards(points: FloatArray, faces: IntArray) -> tuple[IntArray, IntArray]:
    """Turn the triangles of each connected piece of a mesh outwards.

    Returns the faces (m, 3), and the number of each face's piece (m,). A piece is turned if it
    encloses a negative volume; holes count as closed by triangles to the middle of the piece.
    """
    try:
        import igl
    except ImportError as error:
        raise BrdfkitError(
            "Meshes are split into pieces by libigl, which is not installed; pip install "
            "'brdfkit[visibility]'."
        ) from error
    faces, piece = igl.bfs_orient(np.ascontiguousarray(faces, np.int64))
    corners = points[faces]
    count = np.bincount(piece)[:, None]
    middle = np.stack([np.bincount(piece, x) for x in corners.mean(axis=1).T], axis=1) / count
    volume = np.bincount(piece, np.linalg.det(corners - middle[piece, None]))
    return np.where((volume < 0)[piece, None], faces[:, ::-1], faces), piece


def _drop_unused_points(points: FloatArray, faces: IntArray) -> tuple[FloatArray, IntArray]:
    """Return the points and faces of a mesh without the points that belong to no face."""
    used, faces = np.unique(faces, return_inverse=True)
    return points[used], faces.reshape(-1, 3)


def _close_holes(
    points: FloatArray, faces: IntArray, mesh: IntArray
) -> tuple[FloatArray, IntArray]:
    """Close the holes of a piece of a mesh, each by triangles from the mean of its corners.

    Returns the points and faces of the piece, all of whose triangles `faces` have to face out.
    `mesh` (m, 3) are the faces of all pieces, with the same points. A wide hole is closed only if
    other pieces cover it, as the body of a teapot covers the foot of its spout: the winding number
    [Jacobson et al. 2013] in its middle is then 1, but 1/2 at an opening. A piece is returned
    unchanged if it has an opening, or if two of its holes share a corner.
    """
    import igl

    loops = _find_hole_loops(faces)
    if not loops:
        return points, faces
    middles = np.array([points[loop].mean(axis=0) for loop in loops])
    size = np.ptp(points[mesh], axis=(0, 1)).max()
    wide = np.array([np.ptp(points[loop], axis=0).max() > WIDE_HOLE * size for loop in loops])
    if wide.any() and igl.winding_number(points, mesh, middles[wide]).min() < COVERED:
        return points, faces
    fans = [
        [a, b, len(points) + k]
        for k, loop in enumerate(loops)
        for a, b in zip(loop, loop[1:] + loop[:1], strict=True)
    ]
    return np.concatenate([points, middles]), np.concatenate([faces, fans])


def _find_hole_loops(faces: IntArray) -> list[list[int]]:
    """Return the indices of the corners around each hole, in the winding of a face that closes it.

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
