"""Decomposition of a triangle mesh into nearly convex parts, by coacd [Wei et al. 2022].

[Ergun 2015, section 7.1] used HACD, which is no longer maintained. Its parameters have these
counterparts in coacd:

| HACD | here, and in coacd |
| --- | --- |
| Concavity | `concavity`, coacd's threshold: the largest distance between a part and its hull |
| NVerticesPerCH | `hull_vertices`, coacd's max_ch_vertex |
| NTargetTrianglesDecimatedMesh | none; a mesh with an opening is remeshed, as if decimated |
| NClusters, ConnectDist, SmallClusterThreshold, AddExtraDistPoints, AddFacesPoints | none |

A decomposition takes seconds to minutes. It is thus stored in the user's cache folder, as an .npz
file whose name is the checksum of the mesh and the settings.
"""

import hashlib
import json
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from brdfkit.core.array_types import FloatArray, IntArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import make_folder, write_safely
from brdfkit.core.interrupts import restore_interrupt_handler
from brdfkit.lighting.visibility.hull import Hull, make_hull
from brdfkit.lighting.visibility.pieces import split_solids

PROGRAM = Path(__file__).with_name("coacd_process.py")
# coacd's settings of its search, which find as many parts as the defaults in a quarter of the time
SEARCH = {"mcts_iterations": 20, "mcts_nodes": 10, "mcts_max_depth": 2, "resolution": 500}
PREPROCESS = "preprocess_mode"  # coacd's: "off" for a closed mesh, "on" to close an open one
CONCAVITY = 0.03
HULL_VERTICES = 256


def decompose(
    points: FloatArray,
    faces: IntArray,
    concavity: float = CONCAVITY,
    hull_vertices: int = HULL_VERTICES,
) -> list[Hull]:
    """Cut a mesh into nearly convex parts, and return their hulls; none if it encloses no volume.

    `points` (n, 3) are the mesh's vertices, `faces` (m, 3) the vertex numbers of its triangles.
    `concavity` (0.01 to 1) is the largest distance between a part and its hull, relative to half of
    the longest side of the piece's bounding box: larger values give fewer parts. `hull_vertices` (8
    to 10,000) is the largest number of vertices of a hull; one with more is simplified.

    Each closed piece of the mesh is cut separately, after the holes of scans are closed; a convex
    piece is one part. A piece with an opening has no inside: coacd then makes a closed mesh around
    it, by voxels of 1/50 of its size, which is that much too thick.

    The same mesh always has the same parts, whichever way its triangles are turned. Raises
    `BrdfkitError` if coacd or libigl is not installed, or a setting is out of range.
    """
    if not 0.01 <= concavity <= 1:
        raise BrdfkitError(f"concavity = {concavity:g} should be between 0.01 and 1.")
    if not 8 <= hull_vertices <= 10_000:
        raise BrdfkitError(f"hull_vertices = {hull_vertices} should be between 8 and 10000.")
    points, faces = weld_vertices(points, faces)
    if make_hull(points) is None:
        return []
    settings = SEARCH | {"threshold": float(concavity), "max_ch_vertex": int(hull_vertices)}
    closed, others = split_solids(points, faces)
    as_is, remeshed = settings | {PREPROCESS: "off"}, settings | {PREPROCESS: "on"}
    parts = [part for piece in closed for part in _cut_piece(*piece, as_is)]
    if len(others):
        parts += _cut_piece(points, others, remeshed)
    return parts


def _cut_piece(
    points: FloatArray, faces: IntArray, settings: dict[str, int | float | str]
) -> list[Hull]:
    """Cut a piece of a mesh into convex parts, or read them from the cache of earlier calls."""
    whole = make_hull(points[np.unique(faces)])
    if whole is None:
        return []
    if settings[PREPROCESS] == "off" and _fills_its_hull(points, faces):
        return [whole]
    file = find_decomposition_folder() / f"{_checksum_mesh(points, faces, settings)}.npz"
    if not file.is_file():
        _run_coacd(points, faces, settings, file)
    with np.load(file) as stored:
        parts = np.split(stored["points"], stored["ends"][:-1])
    return [hull for part in parts if (hull := make_hull(part)) is not None]


def find_decomposition_folder() -> Path:
    """Return the folder in the user's cache folder in which decompositions are stored."""
    import pooch

    return Path(pooch.os_cache("brdfkit")) / "convex_parts"


def weld_vertices(points: FloatArray, faces: IntArray) -> tuple[FloatArray, IntArray]:
    """Merge a mesh's vertices that are equal in single precision, and drop faces that collapse.

    `points` (n, 3) are the vertices, and `faces` (m, 3) the vertex numbers of triangles.
    """
    points = np.asarray(points, np.float32).astype(float)
    points, number = np.unique(points, axis=0, return_inverse=True)
    faces = number.reshape(-1)[np.asarray(faces)]
    a, b, c = faces.T
    return points, faces[(a != b) & (b != c) & (c != a)]


def _fills_its_hull(points: FloatArray, faces: IntArray) -> bool:
    """Return whether a closed mesh is convex: as large as its hull, within a millionth."""
    from scipy.spatial import ConvexHull

    corners = points[faces] - points.mean(axis=0)
    volume = abs(np.linalg.det(corners).sum()) / 6
    return bool(volume > (1 - 1e-6) * ConvexHull(points).volume)


def _run_coacd(
    points: FloatArray, faces: IntArray, settings: dict[str, int | float | str], file: Path
) -> None:
    """Cut a mesh by coacd in another process, and write its parts to `file`."""
    if not find_spec("coacd"):
        raise BrdfkitError(
            "Convex parts are found by coacd, which is not installed; pip install "
            "'brdfkit[visibility]'."
        )
    settings = settings | {"decimate": True, "seed": 0}
    make_folder(file.parent)
    with TemporaryDirectory() as folder, write_safely(file) as beside:
        mesh = Path(folder) / "mesh.npz"
        np.savez(mesh, points=points, faces=faces)
        status = _run_program([sys.executable, "-P", PROGRAM, mesh, beside, json.dumps(settings)])
        if status:
            raise BrdfkitError(
                f"coacd could not cut a mesh of {len(faces):,} triangles (exit status {status}); "
                "repair the mesh, or give a larger concavity."
            )


def _run_program(command: list[str | Path]) -> int:
    """Run a program until it ends, or Ctrl-C ends both programs; return its exit status."""
    restore_interrupt_handler()  # while Mitsuba renders, its own handler delays Ctrl-C
    process = subprocess.Popen(command, stderr=subprocess.DEVNULL)
    try:
        return process.wait()
    finally:
        process.kill()
        process.wait()


def _checksum_mesh(
    points: FloatArray, faces: IntArray, settings: dict[str, int | float | str]
) -> str:
    """Return the SHA-256, in hexadecimal, of a mesh and the settings of its decomposition."""
    digest = hashlib.sha256(repr(sorted(settings.items())).encode())
    digest.update(np.asarray(points, "<f8").tobytes())
    digest.update(np.asarray(faces, "<i8").tobytes())
    return digest.hexdigest()
