"""Splitting of a mesh into the solids that it consists of, whichever way its triangles are turned.

A modelled object often consists of several surfaces that run into each other: the spout of a teapot
ends within its body. Cutting them as one confuses coacd, and so do triangles that face in: it then
makes a thousand splinters, or does not end within minutes.
"""

import numpy as np

from brdfkit.core.array_types import FloatArray, IntArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.lighting.visibility.holes import close_holes


def split_solids(
    points: FloatArray, faces: IntArray
) -> tuple[list[tuple[FloatArray, IntArray]], IntArray]:
    """Return the closed pieces of a welded mesh, as (points, faces), and the faces of the others.

    A piece is connected by edges that two triangles share. Its triangles are turned so that all
    face out, and its holes are closed. A shell within another, the wall of a cavity, is a solid of
    its own: the cavity is filled, since no light enters it from outside. Raises `BrdfkitError` if
    libigl is not installed.
    """
    faces, piece = _turn_outwards(points, faces)
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
    """Return whether every edge of the welded `faces` (m, 3) belongs to two of them."""
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    _, count = np.unique(edges, axis=0, return_counts=True)
    return bool(np.all(count == 2))


def _turn_outwards(points: FloatArray, faces: IntArray) -> tuple[IntArray, IntArray]:
    """Turn each piece so that it encloses a positive volume; return the faces and their pieces.

    A piece with holes counts as closed from the mean of its corners.
    """
    try:
        import igl
    except ImportError as error:
        raise BrdfkitError(
            "Meshes are taken apart by libigl, which is not installed; pip install "
            "'brdfkit[visibility]'."
        ) from error
    faces, piece = igl.bfs_orient(np.ascontiguousarray(faces, np.int64))
    corners = points[faces]
    count = np.bincount(piece)[:, None]
    middle = np.stack([np.bincount(piece, x) for x in corners.mean(axis=1).T], axis=1) / count
    volume = np.bincount(piece, np.linalg.det(corners - middle[piece, None]))
    return np.where((volume < 0)[piece, None], faces[:, ::-1], faces), piece


def _drop_unused_points(points: FloatArray, faces: IntArray) -> tuple[FloatArray, IntArray]:
    """Return the mesh without the points that belong to no face."""
    used, faces = np.unique(faces, return_inverse=True)
    return points[used], faces.reshape(-1, 3)
