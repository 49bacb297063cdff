"""Cuts a triangle mesh into nearly convex parts, by the library coacd [Wei et al. 2022].

[Ergun 2015, section 7.1] used HACD, which is no longer kept. Of its parameters, coacd has these:

| HACD | here, and in coacd |
| --- | --- |
| Concavity | `concavity`, coacd's threshold: the largest distance between a part and its hull |
| NVerticesPerCH | `hull_vertices`, coacd's max_ch_vertex |
| NTargetTrianglesDecimatedMesh | none; a mesh that is not closed is remeshed, as if decimated |
| NClusters, ConnectDist, SmallClusterThreshold, AddExtraDistPoints, AddFacesPoints | none |

A decomposition takes seconds to minutes. It is kept in the user's cache folder, as an .npz file
named by the checksum of the mesh and the settings, and is made once.
"""

import hashlib
from pathlib import Path

import numpy as np
from scipy.spatial import ConvexHull

from brdfkit.errors import BrdfkitError
from brdfkit.files import make_folder, write_safely
from brdfkit.visibility.holes import close_holes
from brdfkit.visibility.hull import hull

# The search for cuts: coacd's defaults (150, 20, 3 and 2000) find as many parts in 4 times the time
SEARCH = {"mcts_iterations": 20, "mcts_nodes": 10, "mcts_max_depth": 2, "resolution": 500}
CONCAVITY = 0.03
HULL_VERTICES = 256


def decompose(points, faces, concavity=CONCAVITY, hull_vertices=HULL_VERTICES):
    """The convex parts of a mesh, a list of `Hull`; empty for a mesh that encloses nothing.

    points, faces : the vertices (n, 3) of the mesh, and of each triangle (m, 3) their numbers.
    concavity : the largest distance between a part and its hull, 0.01 to 1, where the longest side
        of the mesh's bounding box is 2. Larger: fewer parts.
    hull_vertices : vertices that a hull has at most, 8 to 10,000; a hull of more is simplified.

    A closed mesh that is convex already is its own part, for which coacd is not asked. The holes of
    a scan are closed (`holes.py`). Another mesh that is not closed has no inside: coacd then makes
    a closed one around it, by voxels of 1/50 of its size, which is that much too thick.

    The same mesh always has the same parts. Raises `BrdfkitError` where coacd is not installed, and
    for settings out of range.
    """
    if not 0.01 <= concavity <= 1:
        raise BrdfkitError(f"concavity = {concavity:g} should be between 0.01 and 1.")
    if not 8 <= hull_vertices <= 10_000:
        raise BrdfkitError(f"hull_vertices = {hull_vertices} should be between 8 and 10000.")
    points, faces = weld(points, faces)
    whole = hull(points)
    if whole is None:
        return []
    if is_closed(faces) and _fills_its_hull(points, faces):
        return [whole]
    if not is_closed(faces):
        mended = close_holes(points, faces)
        points, faces = mended if is_closed(mended[1]) else (points, faces)
    settings = SEARCH | {"threshold": float(concavity), "max_ch_vertex": int(hull_vertices)}
    settings["preprocess_mode"] = "off" if is_closed(faces) else "on"
    file = cache() / f"{_checksum(points, faces, settings)}.npz"
    if not file.is_file():
        _write(file, _run_coacd(points, faces, settings))
    with np.load(file) as stored:
        parts = np.split(stored["points"], stored["ends"][:-1])
    return [found for part in parts if (found := hull(part)) is not None]


def cache():
    """The folder of the decompositions, in the user's cache folder."""
    import pooch

    return Path(pooch.os_cache("brdfkit")) / "convex_parts"


def weld(points, faces):
    """The mesh with one vertex where several lie at one point, in single precision, and without
    faces of no area."""
    points = np.asarray(points, np.float32).astype(float)
    points, number = np.unique(points, axis=0, return_inverse=True)
    faces = number.reshape(-1)[np.asarray(faces)]
    a, b, c = faces.T
    return points, faces[(a != b) & (b != c) & (c != a)]


def is_closed(faces):
    """Whether every edge of the welded `faces` (m, 3) belongs to two of them."""
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    _, count = np.unique(edges, axis=0, return_counts=True)
    return bool(np.all(count == 2))


def _fills_its_hull(points, faces):
    """Whether a closed mesh is convex: its volume is that of its hull, within a millionth."""
    corners = points[faces] - points.mean(axis=0)
    volume = abs(np.linalg.det(corners).sum()) / 6
    return volume > (1 - 1e-6) * ConvexHull(points).volume


def _run_coacd(points, faces, settings):
    """The corners of each part's hull, a list of arrays (n, 3)."""
    try:
        import coacd
    except ImportError as error:
        raise BrdfkitError(
            "Convex parts are found by coacd, which is not installed; pip install "
            "'brdfkit[visibility]'."
        ) from error
    coacd.set_log_level("off")
    found = coacd.run_coacd(coacd.Mesh(points, faces), **settings, decimate=True, seed=0)
    return [corners for corners, _ in found]


def _checksum(points, faces, settings):
    """The SHA-256 of a mesh and of how it is cut, in hexadecimal."""
    digest = hashlib.sha256(repr(sorted(settings.items())).encode())
    digest.update(np.ascontiguousarray(points, "<f8"))
    digest.update(np.ascontiguousarray(faces, "<i8"))
    return digest.hexdigest()


def _write(file, parts):
    """Store the corners of all parts, and after how many of them each part ends."""
    make_folder(file.parent)
    ends = np.cumsum([len(part) for part in parts])
    with write_safely(file) as beside:
        np.savez_compressed(beside, points=np.concatenate(parts), ends=ends)
