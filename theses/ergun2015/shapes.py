"""Shapes to light: meshes that lie beside the measurements, and a torus by code."""

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
COLUMNS = 97  # of the torus's profile


@dataclass(frozen=True)
class Shape:
    """`build`: a function of (BSDF, size) that makes the dictionary of a scene, as those of
    `brdfkit.rendering.scenes`; `points` (n, 3), `faces` (m, 3): its triangles as the file has them.
    """

    build: Callable
    points: np.ndarray
    faces: np.ndarray


def find_meshes(sources, names=MESHES):
    """Name → `Shape` of the meshes, models/NAME.obj.xz; where one is missing, a torus for all."""
    files = {name: sources.find_beside(file_of(name)) for name in names}
    if not all(files.values()):
        return {"torus": ring()}
    return {name: unpacked(file) for name, file in files.items()}


def file_of(name):
    """Where a mesh is looked for."""
    return f"models/{name}.obj.xz"


def unpacked(file):
    """The `Shape` of a compressed mesh."""
    with TemporaryDirectory() as folder:
        plain = Path(folder) / file.stem
        plain.write_bytes(read_bytes(file))
        buffers = mesh_file.read_mesh(plain)
    points, _, _, faces = buffers
    return Shape(
        lambda bsdf, size: make_studio(size) | {"mesh": make_mesh(*buffers, bsdf)}, points, faces
    )


def ring():
    """The `Shape` of the torus."""
    import mitsuba as mi

    buffers = mi.traverse(torus({"type": "diffuse"}, (1, 1))["mesh"])
    points, faces = (buffers[name] for name in ("vertex_positions", "faces"))
    return Shape(torus, np.array(points, float).reshape(-1, 3), np.array(faces).reshape(-1, 3))


def torus(bsdf, size):
    """A ring of the ball's size, leaning towards the camera."""
    phi = np.linspace(0, 2 * np.pi, COLUMNS)
    phi[-1] = 0  # the profile closes
    points, normals = revolve_profile(0.68 + 0.32 * np.cos(phi), 0.32 * np.sin(phi))
    points = points.round(9)  # it closes around the axis, too
    lean = np.array([[1, 0, 0], [0, 0.64, 0.768375], [0, -0.768375, 0.64]])
    points = points @ lean + [0, 0, 1]
    return make_studio(size) | {"mesh": make_grid_mesh(points, normals @ lean, bsdf)}
