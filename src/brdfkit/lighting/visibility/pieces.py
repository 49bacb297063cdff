"""Splitting of a mesh into its connected, closed pieces, with all triangles turned outwards.

A modelled object often consists of several surfaces that intersect each other: the spout of a
teapot ends within its body. coacd cannot cut them as one mesh, nor a mesh with triangles that face
inwards: it makes a thousand splinters, or does not end within minutes.
"""

import numpy as np

from brdfkit.core.array_types import FloatArray, IntArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.lighting.visibility.holes import close_holes


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
        mended = close_holes(points, mine, faces)
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
    encloses a negative volume; its holes count as closed from the mean of its corners.
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
