"""Selects the triangles of a mesh that cast its shadow; they are the front caps of the volume.

Each function gives every triangle a whole number: 1 where it casts as it is oriented, -1 where it
casts after it is turned over, so that it faces the light, and 0 where it casts nothing.

all           Every triangle casts but those in whose plane the light is. Right for any mesh, open
              or closed, however its triangles are oriented, and for a light within: as many
              volumes contain a point as triangles lie between it and the light [Bergeron 1986]. An
              edge between a triangle that faced the light and one that did not bounds both, and
              its wall counts twice.
light_facing  Triangles that face the light cast [Ergun 2008, 2.1.6]: half as many, for closed
              meshes.
facing_away   Triangles that do not face the light cast. Behind closed meshes the shadow is the
              same; the insides of the shapes are lit. As the caps never touch a lit surface, they
              do not darken one by mistake.
"""

import numpy as np

from brdfkit.core.array_types import BoolArray, FloatArray, IntArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.projective.light import Light
from brdfkit.shadows.volumes.mesh import Mesh


def select_all_triangles(mesh: Mesh, light: Light) -> IntArray:
    """Return the casting number (m,) of each triangle if all of them cast a shadow.

    It is 1, or -1 for triangles that must be turned over to face the light, or 0 if edge-on.
    """
    return np.sign(compute_facing(mesh, light)).astype(int)


def select_light_facing_triangles(mesh: Mesh, light: Light) -> IntArray:
    """Return the casting number (m,) of each triangle, 1 if it faces the light, else 0.

    Raises `BrdfkitError` unless the mesh is closed and the light outside of it.
    """
    require_solid(mesh, light)
    return is_facing_light(mesh, light).astype(int)


def select_triangles_facing_away(mesh: Mesh, light: Light) -> IntArray:
    """Return the casting number (m,) of each triangle, 0 if it faces the light, else -1.

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
    """Return the cosine (m,) between triangle normals and light, scaled by positive numbers.

    It is 0 where the light is in the triangle's plane.
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
    """Return how often a mesh winds around a point (3,): its triangles' solid angles over 4π.

    It is ±1 inside of a closed mesh and 0 outside [Van Oosterom & Strackee 1983].
    """
    a, b, c = (mesh.points[mesh.triangles] - place).transpose(1, 0, 2)
    x, y, z = (np.linalg.norm(v, axis=1) for v in (a, b, c))
    ab, bc, ca = (np.einsum("ij,ij->i", v, w) for v, w in ((a, b), (b, c), (c, a)))
    over = np.einsum("ij,ij->i", a, np.cross(b, c))
    half_angles = np.arctan2(over, x * y * z + ab * z + bc * x + ca * y)
    return float(np.sum(2 * half_angles) / (4 * np.pi))
