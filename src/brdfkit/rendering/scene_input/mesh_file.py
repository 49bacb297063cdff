"""Makes a scene from a mesh file, OBJ or PLY, in which the mesh takes the place of the ball.

Mesh files do not say which of their axes points up, so the axis is guessed if the user gives none.
"""

import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray, IntArray, MitsubaObject
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import require_file
from brdfkit.mitsuba_bridge.obj_indices import use_absolute_indices
from brdfkit.mitsuba_bridge.properties.picture_file import load_by_mitsuba
from brdfkit.rendering.scenes._meshes import make_mesh
from brdfkit.rendering.scenes._studio import make_studio

SUFFIXES = ".obj", ".ply"
SIZE = 2.0  # longest side of the mesh's bounding box in the scene, the diameter of the ball [m]
SHARP_ANGLE = np.radians(35)  # angle between a corner's and its face's normal at a sharp edge
SMALLEST_AREA = 1e-12  # smallest area of a face, as a share of the squared longest side of the mesh
FOOT_HEIGHT = 0.02  # share of the mesh's height below which a vertex counts as on the ground
FOOT_SHARE = 0.1  # smallest area of a foot, as a share of the mesh's outline from above

# For each axis of a file that may point up: the rotation (axis, degrees) that makes z point up
TURNS: dict[str, tuple[list[int], int]] = {
    "x": ([0, 1, 0], -90),
    "y": ([1, 0, 0], 90),
    "z": ([0, 0, 1], 0),
}


def make_mesh_scene(source: str | Path) -> Callable[..., dict[str, Any]]:
    """Return a function (bsdf, size) that makes the dictionary of a scene with the mesh of a file.

    `source` is the file, "FILE.obj", or the file with the axis that points up, "FILE.obj#z"; by
    default the axis is guessed. If y points up, z points to the camera. The mesh is scaled to the
    size of the ball, and stands on the ground. Missing normals are computed. An anisotropic
    material is brushed along the texture coordinate u, or around the vertical axis if the mesh has
    no texture coordinates.

    Raises `BrdfkitError` for a missing file, for a file that is no mesh, for faces with missing
    vertices or without an area, and for an unknown axis.
    """
    name, _, up = str(source).partition("#")
    if up and up not in TURNS:
        raise BrdfkitError(f"{source}: the axis that points up, behind the #, is x, y or z.")
    path = require_file(name)
    # The list keeps the mesh after the first call, because it is the same for every material
    meshes: list[tuple[FloatArray, FloatArray, FloatArray, IntArray]] = []

    def build_scene(
        bsdf: dict[str, Any] | MitsubaObject, size: tuple[int, int] = (512, 512)
    ) -> dict[str, Any]:
        meshes[:] = meshes or [read_mesh(path, up)]
        return make_studio(size) | {"mesh": make_mesh(*meshes[0], bsdf=bsdf)}

    return build_scene


def read_mesh(path: Path, up: str = "") -> tuple[FloatArray, FloatArray, FloatArray, IntArray]:
    """Read a mesh file, and scale and move the mesh to the place of the ball.

    `up` is the axis of the file that points up; by default it is guessed. Return the points (n, 3),
    their normals (n, 3), texture coordinates (n, 2), and the faces (m, 3), which are indices of
    points.
    """
    import mitsuba as mi

    with use_absolute_indices(path) as file:

        def load_mesh(**settings: Any) -> MitsubaObject:
            plugin = {"type": path.suffix.lower()[1:], "filename": str(file)}
            return mi.traverse(load_by_mitsuba(mi.load_dict, plugin | settings, path))

        # To find its size, the mesh is first loaded without normals: Mitsuba cannot compute normals
        # if faces are missing or very small
        points, faces = _read_points_and_faces(load_mesh(face_normals=True), path)
        middle, extent = _find_bounding_box(points, faces, path)
        to_world = mi.ScalarTransform4f().rotate(
            *TURNS[up or _guess_up_axis_with_warning(path, points, faces)]
        )
        to_world = to_world.scale([SIZE / extent] * 3).translate((-middle).tolist())
        buffers = load_mesh(to_world=to_world)

    # In the arrays (faces, corners, 3) below, faces share no vertices; coordinates are the scene's
    points, faces = _read_points_and_faces(buffers, path)
    faces = faces[_compute_triangle_areas(points, faces) > SMALLEST_AREA * SIZE**2]
    normals, uv = (
        np.array(buffers[name]).reshape(-1, width)
        for name, width in (("vertex_normals", 3), ("vertex_texcoords", 2))
    )
    points, normals = points[faces], normals[faces]
    points[..., 2] -= points[..., 2].min()
    uv = uv[faces] if len(uv) else _make_uv_around_axis(points)
    normals = _keep_sharp_edges(normals, points)
    points, normals, uv = (x.reshape(-1, x.shape[-1]) for x in (points, normals, uv))
    return points, normals, uv, np.arange(faces.size).reshape(-1, 3)


def _guess_up_axis_with_warning(path: Path, points: FloatArray, faces: IntArray) -> str:
    """Guess which axis of a mesh points up, "y" or "z", and warn if it is z."""
    up = guess_up_axis(points[np.unique(faces)])
    if up != "y":
        warnings.warn(
            f"{path}: its axis {up} is taken to point up, because the mesh then stands on its "
            f"foot, and would fall over with y up. If not, give --up y, in Python '{path}#y'.",
            stacklevel=2,
        )
    return up


def _read_points_and_faces(buffers: MitsubaObject, path: Path) -> tuple[FloatArray, IntArray]:
    """Return the points (n, 3) of a mesh and its faces (m, 3), which are indices of points.

    `buffers` are Mitsuba's parameters of the mesh. Raises `BrdfkitError` for an index without a
    point.
    """
    points = np.array(buffers["vertex_positions"], float).reshape(-1, 3)
    faces = np.array(buffers["faces"]).reshape(-1, 3)
    if faces.size and faces.max() >= len(points):
        raise BrdfkitError(
            f"{path}: a face has a vertex that the mesh lacks, beyond its {len(points)}; export it "
            "again."
        )
    return points, faces


def _find_bounding_box(points: FloatArray, faces: IntArray, path: Path) -> tuple[FloatArray, float]:
    """Return the middle (3,) and the longest side of the bounding box of the `faces`.

    Raises `BrdfkitError` if no face has an area.
    """
    used = points[faces] if faces.size else np.zeros((1, 3, 3))
    low, high = used.min(axis=(0, 1)), used.max(axis=(0, 1))
    extent = float(np.max(high - low))
    if not (
        0 < extent < np.inf
        and np.any(_compute_triangle_areas(points, faces) > SMALLEST_AREA * extent**2)
    ):
        raise BrdfkitError(f"{path}: the mesh has no faces, or none with an area; export it again.")
    return (low + high) / 2, extent


def _compute_triangle_areas(points: FloatArray, faces: IntArray) -> FloatArray:
    """Return the areas (m,) of the triangles `faces` (m, 3), indices of `points` (n, 3)."""
    a, b, c = np.moveaxis(points[faces], 1, 0)
    return np.linalg.norm(np.cross(b - a, c - a), axis=-1) / 2


def _keep_sharp_edges(normals: FloatArray, points: FloatArray) -> FloatArray:
    """Return the normals at the corners of faces, without smoothing across sharp edges.

    If the normal at a corner differs much from the face's own normal, the edge is meant to be
    sharp, and the face's own normal replaces it. All arrays are (faces, 3 corners, 3).
    """
    flat = np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
    flat /= np.maximum(np.linalg.norm(flat, axis=-1, keepdims=True), 1e-30)
    flat = np.broadcast_to(flat[:, None], normals.shape)
    cos = np.einsum("fci,fci->fc", flat, normals)
    # Where the cosine is negative, the vertices of the face run the wrong way round
    sharp = np.abs(cos) < np.cos(SHARP_ANGLE)
    return np.where(sharp[..., None], np.where(cos < 0, -1, 1)[..., None] * flat, normals)


def _make_uv_around_axis(points: FloatArray) -> FloatArray:
    """Return texture coordinates (m, 3, 2) at the three corners of m faces, for a mesh without any.

    u is the angle around the vertical axis, which does not jump within a face; v is the angle from
    that axis. Both are in radians.
    """
    x, y, z = np.moveaxis(points, -1, 0)
    u = np.unwrap(np.arctan2(y, x), axis=1)
    return np.stack([u, np.arctan2(np.hypot(x, y), z - z.max() / 2)], axis=-1)


def guess_up_axis(points: FloatArray) -> str:
    """Guess which axis of a mesh points up, "y" or "z", from its vertices (n, 3).

    A solid stands if the centroid of its convex hull is above its foot, which is the convex polygon
    around the vertices that touch the ground, and if this foot is not a mere tip. The guess is "z"
    if the mesh stands with z up but not with y up. Otherwise it is "y", the convention of OBJ
    files; a cube, for example, stands both ways, and a sheet neither way.
    """
    return "z" if _stands_upright(points, 2) and not _stands_upright(points, 1) else "y"


def _stands_upright(points: FloatArray, axis: int) -> bool:
    """Return whether a solid with the vertices `points` (n, 3) stands if `axis` points up."""
    from scipy.spatial import ConvexHull, QhullError

    level = [k for k in range(3) if k != axis]
    height = points[:, axis] - points[:, axis].min()
    try:
        hull = ConvexHull(points)
        foot = ConvexHull(points[height < FOOT_HEIGHT * height.max()][:, level])
        outline = ConvexHull(points[:, level])
    except (QhullError, ValueError):  # the mesh is flat, or touches the ground at too few points
        return False
    corners = points[hull.simplices] - points[hull.vertices].mean(axis=0)
    volumes = np.abs(np.linalg.det(corners))
    middle = points[hull.vertices].mean(axis=0) + volumes @ corners.sum(axis=1) / 4 / volumes.sum()
    inside = np.all(foot.equations @ np.append(middle[level], 1) < 0)
    # For a polygon, SciPy's attribute `volume` is the area
    return bool(inside and foot.volume > FOOT_SHARE * outline.volume)
