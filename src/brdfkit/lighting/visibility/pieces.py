"""Takes a mesh apart into the solids of which it is made, whichever way its triangles are turned.

A modelled object is often several surfaces that run into each other: the spout of a teapot ends
within its body. To cut them as one confuses the library that cuts, and so do triangles that face
in: it then makes a thousand splinters, or does not end within minutes.
"""

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.lighting.visibility.holes import close_holes


def solids(points, faces):
    """(The closed pieces of a welded mesh, a list of (points, faces); the faces of the others).

    A piece is what hangs together by edges that two triangles share. Its triangles are turned so
    that all face out, and its holes are closed. A shell within another, the wall of a cavity, is a
    solid of its own: the cavity is filled, into which no light comes from outside.

    Raises `BrdfkitError` where libigl is not installed.
    """
    faces, piece = _facing_out(points, faces)
    closed, others = [], []
    for number in range(piece.max() + 1):
        mine = faces[piece == number]
        mended = close_holes(points, mine, faces)
        if is_closed(mended[1]):
            closed.append(_used(*mended))
        else:
            others.append(mine)
    return closed, np.concatenate(others) if others else np.empty((0, 3), int)


def is_closed(faces):
    """Whether every edge of the welded `faces` (m, 3) belongs to two of them."""
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    _, count = np.unique(edges, axis=0, return_counts=True)
    return bool(np.all(count == 2))


def _facing_out(points, faces):
    """(The faces, each piece of them turned to enclose a volume above 0; the number of its piece).

    A piece with holes is closed in thought, from the mean of its corners.
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


def _used(points, faces):
    """The mesh without the points that no face has."""
    used, faces = np.unique(faces, return_inverse=True)
    return points[used], faces.reshape(-1, 3)
