"""Selects the triangles of a mesh that cast its shadow; they become the volume's front caps.

Each function gives every triangle a casting number: 1 if it casts a shadow as it is oriented, -1 if
it is turned over first, so that it faces the light, and 0 if it casts no shadow.

all           All triangles cast, except those whose plane contains the light. This suits any mesh,
              open or closed, however its triangles are oriented, even around the light: a point is
              in as many volumes as triangles lie between it and the light [Bergeron 1986]. At the
              silhouette two triangles share an edge, whose wall counts twice.
light_facing  The triangles that face the light cast [Ergun 2008, 2.1.6]. They are half as many, but
              the mesh must be closed.
facing_away   The triangles that face away from the light cast. Behind closed meshes the shadow is
              the same, but the insides of the shapes are lit. The caps never touch a lit surface,
              so they do not darken one by mistake.
"""

import numpy as np

from brdfkit.core.array_types import BoolArray, FloatArray, IntArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.projective.light import Light
from brdfkit.shadows.volumes.mesh import Mesh


def select_all_triangles(mesh: Mesh, light: Light) -> IntArray:
    """Return the casting number (m,) of each triangle of a mesh if all of them cast a shadow.

    It is 1 for triangles that face the light, -1 if they face away, and 0 if they are edge-on.
    """
    return np.sign(compute_facing(mesh, light)).astype(int)


def select_light_facing_triangles(mesh: Mesh, light: Light) -> IntArray:
    """Return the casting number (m,) of each triangle of a mesh: 1 if it faces the light, else 0.

    Raises `BrdfkitError` unless the mesh is closed and the light outside of it.
    """
    require_solid(mesh, light)
    return is_facing_light(mesh, light).astype(int)


def select_triangles_facing_away(mesh: Mesh, light: Light) -> IntArray:
    """Return the casting number (m,) of each triangle of a mesh: 0 if it faces the light, else -1.

    Raises `BrdfkitError` unless the mesh is closed and the light outside of it.
    """
    require_solid(mesh, light)
    return is_facing_light(mesh, light).astype(int) - 1


CASTERS = {
    "all": select_all_triangles,
    "light_facing": select_light_facing_triangles,
    "facing_away": select_triangles_facing_away,
}


def is_facing_light(mesh: Mesh, light: Light) -> BoolArray:
    """Return whether each triangle (m,) faces a light."""
    facing: BoolArray = compute_facing(mesh, light) > 0
    return facing


def compute_facing(mesh: Mesh, light: Light) -> FloatArray:
    """Return a number (m,) per triangle: above 0 if it faces the light, below 0 if it faces away.

    It is proportional to the cosine between the triangle's normal and the direction to the light.
    """
    corner = mesh.points[mesh.triangles[:, 0]]
    to_light = light.point[:3] - light.point[3] * corner
    facing: FloatArray = np.einsum("ij,ij->i", mesh.normals, to_light)
    return facing


def require_solid(mesh: Mesh, light: Light) -> None:
    """Raise `BrdfkitError` unless the mesh is closed, and the light outside of it."""
    _ = mesh.shared_edges
    if not light.is_directional and round(winding_number(mesh, light.point[:3])) != 0:
        raise BrdfkitError(
            f"{mesh.name}: the light is inside this shape; move it out, or use casters = all."
        )


def winding_number(mesh: Mesh, place: FloatArray) -> float:
    """Return how often a mesh winds around a point (3,): ±1 inside a closed mesh, 0 outside.

    It is the sum of the signed solid angles of the triangles, divided by 4π [Van Oosterom &
    Strackee 1983].
    """
    a, b, c = (mesh.points[mesh.triangles] - place).transpose(1, 0, 2)
    x, y, z = (np.linalg.norm(v, axis=1) for v in (a, b, c))
    ab, bc, ca = (np.einsum("ij,ij->i", v, w) for v, w in ((a, b), (b, c), (c, a)))
    over = np.einsum("ij,ij->i", a, np.cross(b, c))
    half_angles = np.arctan2(over, x * y * z + ab * z + bc * x + ca * y)
    return float(np.sum(2 * half_angles) / (4 * np.pi))
