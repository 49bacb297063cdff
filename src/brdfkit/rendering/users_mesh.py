"""A mesh of the user's, OBJ or PLY, as a scene: it stands in the place of the ball."""

from pathlib import Path

import numpy as np

from brdfkit.errors import BrdfkitError
from brdfkit.host.load_by_mitsuba import load_by_mitsuba
from brdfkit.rendering.scenes._meshes import mesh
from brdfkit.rendering.scenes._studio import studio

SUFFIXES = ".obj", ".ply"
SIZE = 2.0  # of the longest side of its bounding box, as of the ball's
SHARP = np.radians(35)  # between a normal at a corner of a face and the face's own
AXES = np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]])  # row vectors: y becomes z, and z -y


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
    # of an empty mesh Mitsuba says that it has no normals: it is loaded without them first
    flat = load_by_mitsuba(mi.load_dict, file | {"face_normals": True}, path)
    low, high = (np.array(corner).ravel() for corner in (flat.bbox().min, flat.bbox().max))
    extent = np.max(high - low)
    if not (flat.face_count() and 0 < extent < np.inf):
        raise BrdfkitError(f"{path}: the mesh has no faces, or none with an area; export it anew.")
    buffers = mi.traverse(load_by_mitsuba(mi.load_dict, file, path))
    points, normals, uv, faces = (
        np.array(buffers[name]).reshape(-1, width)
        for name, width in (
            ("vertex_positions", 3),
            ("vertex_normals", 3),
            ("vertex_texcoords", 2),
            ("faces", 3),
        )
    )

    # (faces, corners, 3), in the axes of the scenes; a face has its corners to itself
    points = ((points - (low + high) / 2) * (SIZE / extent))[faces] @ AXES
    normals = normals[faces] @ AXES
    points[..., 2] -= points[..., 2].min()
    uv = uv[faces] if len(uv) else _around(points)
    corners = (x.reshape(-1, x.shape[-1]) for x in (points, _sharpen(normals, points), uv))
    return *corners, np.arange(faces.size).reshape(-1, 3)


def _sharpen(normals, points):
    """The normals at the corners of faces; those of the faces where the two differ much, at edges
    which the mesh means to be sharp."""
    flat = np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
    flat /= np.maximum(np.linalg.norm(flat, axis=-1, keepdims=True), 1e-30)
    flat = np.broadcast_to(flat[:, None], normals.shape)
    cos = np.einsum("fci,fci->fc", flat, normals)
    # below 0: the face is turned, and its corners are right
    sharp = np.abs(cos) < np.cos(SHARP)
    return np.where(sharp[..., None], np.sign(cos)[..., None] * flat, normals)


def _around(points):
    """(u, v) at the corners of faces: the angle around the vertical axis, which does not jump
    within a face, and the angle from that axis."""
    x, y, z = np.moveaxis(points, -1, 0)
    u = np.unwrap(np.arctan2(y, x), axis=1)
    return np.stack([u, np.arctan2(np.hypot(x, y), z - z.max() / 2)], axis=-1)
