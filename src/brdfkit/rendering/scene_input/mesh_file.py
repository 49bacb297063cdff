"""A mesh of the user's, OBJ or PLY, as a scene: it stands in the place of the ball."""

import warnings

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import require_file
from brdfkit.mitsuba_bridge.obj_indices import use_absolute_indices
from brdfkit.mitsuba_bridge.properties.picture_file import load_by_mitsuba
from brdfkit.rendering.scene_input.upright import guess_up
from brdfkit.rendering.scenes._meshes import make_mesh
from brdfkit.rendering.scenes._studio import make_studio

SUFFIXES = ".obj", ".ply"
SIZE = 2.0  # of the longest side of its bounding box, as of the ball's
SHARP = np.radians(35)  # between a normal at a corner of a face and the face's own
LEAST = 1e-12  # area of a face, for a mesh of extent 1


# Turns of the file's axes (axis, degrees) to those of the scenes, where z is up
TURNS = {"x": ([0, 1, 0], -90), "y": ([1, 0, 0], 90), "z": ([0, 0, 1], 0)}


def mesh_scene(given):
    """A function like those of `brdfkit.rendering.scenes`, which shows the mesh in a file.

    `given`: the file, "FILE.obj"; or with the axis that points up, "FILE.obj#z", which is else
    guessed (`upright.py`). With y up, z points to the camera. The mesh, by the vertices of its
    faces, is made as large as the ball and stands on the ground. Normals are made where it has
    none. An anisotropic material is brushed along the u of its texture coordinates, or around its
    vertical axis where it has none. Raises `BrdfkitError` for a file that is missing or not such a
    mesh, for one whose faces lack vertices or an area, and for an axis that there is not.
    """
    name, _, up = str(given).partition("#")
    if up and up not in TURNS:
        raise BrdfkitError(f"{given}: the axis that points up, behind the #, is x, y or z.")
    path = require_file(name)
    made = []  # the same mesh serves every material, and is read once

    def build(bsdf, size=(512, 512)):
        made[:] = made or [read(path, up)]
        return make_studio(size) | {"mesh": make_mesh(*made[0], bsdf)}

    return build


def read(path, up=""):
    """(points, normals, uv, faces) of the mesh in a file, in the ball's place.

    `up`: the axis of the file that points up; it is guessed where none is given.
    """
    import mitsuba as mi

    with use_absolute_indices(path) as file:

        def load(**how):
            plugin = {"type": path.suffix.lower()[1:], "filename": str(file)}
            return mi.traverse(load_by_mitsuba(mi.load_dict, plugin | how, path))

        # without normals at first: Mitsuba makes none of faces that are none, or very small
        points, faces = _points_and_faces(load(face_normals=True), path)
        middle, extent = _box(points, faces, path)
        to_world = mi.ScalarTransform4f().rotate(*TURNS[up or _guess(path, points, faces)])
        to_world = to_world.scale([SIZE / extent] * 3).translate((-middle).tolist())
        buffers = load(to_world=to_world)

    # (faces, corners, 3), in the axes of the scenes; a face has its corners to itself
    points, faces = _points_and_faces(buffers, path)
    faces = faces[_areas(points, faces) > LEAST * SIZE**2]
    normals, uv = (
        np.array(buffers[name]).reshape(-1, width)
        for name, width in (("vertex_normals", 3), ("vertex_texcoords", 2))
    )
    points, normals = points[faces], normals[faces]
    points[..., 2] -= points[..., 2].min()
    uv = uv[faces] if len(uv) else _around(points)
    corners = (x.reshape(-1, x.shape[-1]) for x in (points, _sharpen(normals, points), uv))
    return *corners, np.arange(faces.size).reshape(-1, 3)


def _guess(path, points, faces):
    """The axis that points up, y or z; a warning says where that is not y."""
    up = guess_up(points[np.unique(faces)])
    if up != "y":
        warnings.warn(
            f"{path}: its axis {up} is taken to point up, for the mesh stands on its foot that "
            f"way, and would fall over with y up. If not, give --up y, in Python '{path}#y'.",
            stacklevel=2,
        )
    return up


def _points_and_faces(buffers, path):
    """The points (n, 3) of a mesh and its faces (m, 3), their numbers, which should exist."""
    points = np.array(buffers["vertex_positions"], float).reshape(-1, 3)
    faces = np.array(buffers["faces"]).reshape(-1, 3)
    if faces.size and faces.max() >= len(points):
        raise BrdfkitError(
            f"{path}: a face has a vertex that the mesh lacks, beyond its {len(points)}; export it "
            "anew."
        )
    return points, faces


def _box(points, faces, path):
    """The middle of the bounding box of the `faces`, and its longest side."""
    used = points[faces] if faces.size else np.zeros((1, 3, 3))
    low, high = used.min(axis=(0, 1)), used.max(axis=(0, 1))
    extent = np.max(high - low)
    if not (0 < extent < np.inf and np.any(_areas(points, faces) > LEAST * extent**2)):
        raise BrdfkitError(f"{path}: the mesh has no faces, or none with an area; export it anew.")
    return (low + high) / 2, extent


def _areas(points, faces):
    a, b, c = np.moveaxis(points[faces], 1, 0)
    return np.linalg.norm(np.cross(b - a, c - a), axis=-1) / 2


def _sharpen(normals, points):
    """The normals at the corners of faces; those of the faces where the two differ much, at edges
    which the mesh means to be sharp."""
    flat = np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
    flat /= np.maximum(np.linalg.norm(flat, axis=-1, keepdims=True), 1e-30)
    flat = np.broadcast_to(flat[:, None], normals.shape)
    cos = np.einsum("fci,fci->fc", flat, normals)
    # below 0: the face is turned, and its corners are right
    sharp = np.abs(cos) < np.cos(SHARP)
    return np.where(sharp[..., None], np.where(cos < 0, -1, 1)[..., None] * flat, normals)


def _around(points):
    """(u, v) at the corners of faces: the angle around the vertical axis, which does not jump
    within a face, and the angle from that axis."""
    x, y, z = np.moveaxis(points, -1, 0)
    u = np.unwrap(np.arctan2(y, x), axis=1)
    return np.stack([u, np.arctan2(np.hypot(x, y), z - z.max() / 2)], axis=-1)
