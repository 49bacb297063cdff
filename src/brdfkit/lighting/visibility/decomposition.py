"""Cuts a triangle mesh into nearly convex parts, by the library coacd [Wei et al. 2022].

[Ergun 2015, section 7.1] used HACD, which is no longer kept. Of its parameters, coacd has these:

| HACD | here, and in coacd |
| --- | --- |
| Concavity | `concavity`, coacd's threshold: the largest distance between a part and its hull |
| NVerticesPerCH | `hull_vertices`, coacd's max_ch_vertex |
| NTargetTrianglesDecimatedMesh | none; a mesh with an opening is remeshed, as if decimated |
| NClusters, ConnectDist, SmallClusterThreshold, AddExtraDistPoints, AddFacesPoints | none |

A decomposition takes seconds to minutes. It is kept in the user's cache folder, as an .npz file
named by the checksum of the mesh and the settings, and is made once.
"""

import hashlib
import json
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import make_folder, write_safely
from brdfkit.core.interrupts import give_back_interrupts
from brdfkit.lighting.visibility.hull import hull
from brdfkit.lighting.visibility.pieces import solids

PROGRAM = Path(__file__).with_name("coacd_process.py")
# The search for cuts: coacd's defaults (150, 20, 3 and 2000) find as many parts in 4 times the time
SEARCH = {"mcts_iterations": 20, "mcts_nodes": 10, "mcts_max_depth": 2, "resolution": 500}
AS = "preprocess_mode"  # coacd's: "off" for a closed mesh, "on" for one that is to be made closed
CONCAVITY = 0.03
HULL_VERTICES = 256


def decompose(points, faces, concavity=CONCAVITY, hull_vertices=HULL_VERTICES):
    """The convex parts of a mesh, a list of `Hull`; empty for a mesh that encloses nothing.

    points, faces : the vertices (n, 3) of the mesh, and of each triangle (m, 3) their numbers.
    concavity : the largest distance between a part and its hull, 0.01 to 1, where the longest side
        of the bounding box of the piece of the mesh is 2. Larger: fewer parts.
    hull_vertices : vertices that a hull has at most, 8 to 10,000; a hull of more is simplified.

    Each closed piece of the mesh is cut by itself (`pieces.py`, which closes the holes of scans);
    one that is convex is a part as it is. What has an opening has no inside: coacd then makes a
    closed mesh around it, by voxels of 1/50 of its size, which is that much too thick.

    The same mesh always has the same parts, whichever way its triangles are turned. Raises
    `BrdfkitError` where coacd or libigl is not installed, and for settings out of range.
    """
    if not 0.01 <= concavity <= 1:
        raise BrdfkitError(f"concavity = {concavity:g} should be between 0.01 and 1.")
    if not 8 <= hull_vertices <= 10_000:
        raise BrdfkitError(f"hull_vertices = {hull_vertices} should be between 8 and 10000.")
    points, faces = weld(points, faces)
    if hull(points) is None:
        return []
    settings = SEARCH | {"threshold": float(concavity), "max_ch_vertex": int(hull_vertices)}
    closed, others = solids(points, faces)
    parts = [part for piece in closed for part in _cut(*piece, settings | {AS: "off"})]
    if len(others):
        parts += _cut(points, others, settings | {AS: "on"})
    return parts


def _cut(points, faces, settings):
    """The parts of one mesh; kept, but of one that is convex."""
    whole = hull(points[np.unique(faces)])
    if whole is None:
        return []
    if settings[AS] == "off" and _fills_its_hull(points, faces):
        return [whole]
    file = cache() / f"{_checksum(points, faces, settings)}.npz"
    if not file.is_file():
        _run_coacd(points, faces, settings, file)
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


def _fills_its_hull(points, faces):
    """Whether a closed mesh is convex: its volume is that of its hull, within a millionth."""
    from scipy.spatial import ConvexHull

    corners = points[faces] - points.mean(axis=0)
    volume = abs(np.linalg.det(corners).sum()) / 6
    return volume > (1 - 1e-6) * ConvexHull(points).volume


def _run_coacd(points, faces, settings, file):
    """Write the parts of a mesh to `file`, by a process that does not outlive this call."""
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
        program = [sys.executable, "-P", PROGRAM, mesh, beside, json.dumps(settings)]
        status = _run(program)
        if status:
            raise BrdfkitError(
                f"coacd could not cut a mesh of {len(faces):,} triangles (exit status {status}); "
                "repair the mesh, or give a larger concavity."
            )


def _run(program):
    """The exit status of a program, which ends with this call, also by Ctrl-C."""
    give_back_interrupts()  # Mitsuba's handler, while it renders, waits for the picture
    process = subprocess.Popen(program, stderr=subprocess.DEVNULL)
    try:
        return process.wait()
    finally:
        process.kill()
        process.wait()


def _checksum(points, faces, settings):
    """The SHA-256 of a mesh and of how it is cut, in hexadecimal."""
    digest = hashlib.sha256(repr(sorted(settings.items())).encode())
    digest.update(np.ascontiguousarray(points, "<f8"))
    digest.update(np.ascontiguousarray(faces, "<i8"))
    return digest.hexdigest()
