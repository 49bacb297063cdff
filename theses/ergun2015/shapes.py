"""Loads the meshes of the claims, which lie beside the measurements, and makes a torus."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from brdfkit.core.files import read_bytes
from brdfkit.rendering.scene_input import mesh_file
from brdfkit.rendering.scenes._meshes import make_grid_mesh, make_mesh, revolve_profile
from brdfkit.rendering.scenes._studio import make_studio

MESHES = (
    "alligator",
    "beetle",
    "cheburashka",
    "cow",
    "fandisk",
    "homer",
    "rocker-arm",
    "spot",
    "stanford-bunny",
    "suzanne",
    "teapot",
    "woody",
)
COLUMNS = 97  # points of the torus's profile


@dataclass(frozen=True)
class Shape:
    """A mesh, and a function that places it in a scene.

    build : a function of a BSDF and a picture size that returns a scene's dictionary.
    points : the vertices (n, 3) as the file has them.
    faces : the vertex numbers (m, 3) of the triangles.
    """

    build: Callable
    points: np.ndarray
    faces: np.ndarray


def find_meshes(sources, names=MESHES):
    """Return a `Shape` by name for each mesh, models/NAME.obj.xz, or a torus if one is missing."""
    files = {name: sources.find_beside(find_mesh_path(name)) for name in names}
    if not all(files.values()):
        return {"torus": make_torus_shape()}
    return {name: load_shape(file) for name, file in files.items()}


def find_mesh_path(name):
    """Return the path of a mesh beside the folder of measurements."""
    return f"models/{name}.obj.xz"


def load_shape(file):
    """Load a `Shape` from a compressed mesh file."""
    with TemporaryDirectory() as folder:
        plain = Path(folder) / file.stem
        plain.write_bytes(read_bytes(file))
        buffers = mesh_file.read_mesh(plain)
    points, _, _, faces = buffers
    return Shape(
        lambda bsdf, size: make_studio(size) | {"mesh": make_mesh(*buffers, bsdf)}, points, faces
    )


def make_torus_shape():
    """Return the `Shape` of a torus, which needs no file."""
    import mitsuba as mi

    buffers = mi.traverse(make_torus_scene({"type": "diffuse"}, (1, 1))["mesh"])
    points, faces = (buffers[name] for name in ("vertex_positions", "faces"))
    return Shape(
        make_torus_scene, np.array(points, float).reshape(-1, 3), np.array(faces).reshape(-1, 3)
    )


def make_torus_scene(bsdf, size):
    """Return the scene of a torus of the ball's size, leaning towards the camera."""
    phi = np.linspace(0, 2 * np.pi, COLUMNS)
    phi[-1] = 0  # exactly the first angle, so that the profile closes
    points, normals = revolve_profile(0.68 + 0.32 * np.cos(phi), 0.32 * np.sin(phi))
    points = points.round(9)  # equal points at both ends of a turn, so that the mesh closes
    lean = np.array([[1, 0, 0], [0, 0.64, 0.768375], [0, -0.768375, 0.64]])
    points = points @ lean + [0, 0, 1]
    return make_studio(size) | {"mesh": make_grid_mesh(points, normals @ lean, bsdf)}
