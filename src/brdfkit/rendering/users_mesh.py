"""A mesh of the user's, OBJ or PLY, as a scene: it stands in the place of the ball."""

from pathlib import Path

import numpy as np

from brdfkit.errors import BrdfkitError
from brdfkit.host.load_by_mitsuba import load_by_mitsuba
from brdfkit.rendering.scenes._meshes import mesh
from brdfkit.rendering.scenes._studio import studio

SUFFIXES = ".obj", ".ply"
SIZE = 2.0  # of the longest side of its bounding box, as of the ball's


def mesh_scene(path):
    """A function like those of `brdfkit.rendering.scenes`, which shows the mesh in a file.

    The axis y of the file points up, and z to the camera. The mesh is made as large as the ball and
    stands on the ground. Normals are made where it has none. An anisotropic material is brushed
    along the u of its texture coordinates, or around its vertical axis where it has none. Raises
    `BrdfkitError` for a file that is missing or not such a mesh, and for one without faces.
    """
    path = Path(path)
    if not path.is_file():
        raise BrdfkitError(f"{path}: there is no such mesh; check the path.")
    made = []  # the same mesh serves every material, and is read once

    def build(bsdf, size=(512, 512)):
        made[:] = made or [_read(path)]
        return studio(size) | {"mesh": mesh(*made[0], bsdf)}

    return build


def _read(path):
    """(points, normals, uv, faces) of the mesh in a file, in the ball's place."""
    import mitsuba as mi

    file = {"type": path.suffix.lower()[1:], "filename": str(path)}
    read = load_by_mitsuba(mi.load_dict, file, path)
    buffers = mi.traverse(read)
    points, normals = (np.array(buffers[f"vertex_{n}"]).reshape(-1, 3) for n in ("positions", "normals"))
    uv, faces = np.array(buffers["vertex_texcoords"]), np.array(buffers["faces"]).reshape(-1, 3)

    used = points[np.unique(faces)]
    low, high = (used.min(axis=0), used.max(axis=0)) if len(used) else (0, 0)
    extent = np.max(high - low)
    if not 0 < extent < np.inf:
        raise BrdfkitError(f"{path}: the mesh has no faces, or none with an area; export it anew.")
    points = (points - (low + high) / 2) * (SIZE / extent)
    points, normals = (np.stack([a[:, 0], -a[:, 2], a[:, 1]], axis=-1) for a in (points, normals))
    points = points - (0, 0, points[np.unique(faces), 2].min())
    if len(uv):
        return points, normals, uv.reshape(-1, 2), faces
    return _unweld(points, normals, faces)


def _unweld(points, normals, faces):
    """(points, normals, uv, faces) with three vertices of its own for each face, so that u, the
    angle around the vertical axis, does not jump within a face; v is the angle from the axis."""
    x, y, z = np.moveaxis(points[faces], -1, 0)
    u, v = np.arctan2(y, x), np.arctan2(np.hypot(x, y), z - points[:, 2].max() / 2)
    u = np.unwrap(u, axis=1)
    new = np.arange(faces.size).reshape(-1, 3)
    return points[faces].reshape(-1, 3), normals[faces].reshape(-1, 3), np.dstack([u, v]), new
