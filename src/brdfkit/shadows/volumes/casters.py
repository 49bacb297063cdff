"""Which triangles of a mesh cast its shadow; they are the front caps of the volumes.

Each function gives every triangle a whole number: 1 where it casts as it is oriented, -1 where it
casts turned over, so that it faces the light, and 0 where it casts nothing.

all           Every triangle but those in whose plane the light is. Right for any mesh, open or
              closed, however its triangles are oriented, and for a light within: a point is dark by
              as many triangles as lie between it and the light [Bergeron 1986]. An edge between a
              triangle that faced the light and one that did not bounds both, and its wall counts
              twice.
light_facing  Triangles that face the light [Ergun 2008, 2.1.6]: half as many, for closed meshes.
facing_away   Triangles that do not face it. Behind closed meshes the shadow is the same; the
              insides of the shapes are lit. Its caps never touch a lit surface, so that none is
              darkened by its own cap.
"""

import numpy as np

from brdfkit.core.array_types import BoolArray, FloatArray, IntArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.projective.light import Light
from brdfkit.shadows.volumes.mesh import Mesh


def cast_all(mesh: Mesh, light: Light) -> IntArray:
    """Return for each triangle (m,) how its shadow volume counts if every triangle casts one."""
    return np.sign(compute_facing(mesh, light)).astype(int)


def cast_light_facing(mesh: Mesh, light: Light) -> IntArray:
    """Return for each triangle (m,) how its shadow volume counts if only lit triangles cast one."""
    require_solid(mesh, light)
    return is_facing_light(mesh, light).astype(int)


def cast_facing_away(mesh: Mesh, light: Light) -> IntArray:
    """Return (m,) how each triangle casts if those that face away from the light do."""
    require_solid(mesh, light)
    return is_facing_light(mesh, light).astype(int) - 1


CASTERS = {"all": cast_all, "light_facing": cast_light_facing, "facing_away": cast_facing_away}


def is_facing_light(mesh: Mesh, light: Light) -> BoolArray:
    """Return whether each triangle (m,) faces a light."""
    facing: BoolArray = compute_facing(mesh, light) > 0
    return facing


def compute_facing(mesh: Mesh, light: Light) -> FloatArray:
    """Return N · L (m,) of each triangle, of any scale; 0 where the light is in its plane."""
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
    """Return how often a mesh winds about a place (3,): its triangles' solid angles over 4π.

    [Van Oosterom & Strackee 1983]
    """
    a, b, c = (mesh.points[mesh.triangles] - place).transpose(1, 0, 2)
    x, y, z = (np.linalg.norm(v, axis=1) for v in (a, b, c))
    ab, bc, ca = (np.einsum("ij,ij->i", v, w) for v, w in ((a, b), (b, c), (c, a)))
    over = np.einsum("ij,ij->i", a, np.cross(b, c))
    half_angles = np.arctan2(over, x * y * z + ab * z + bc * x + ca * y)
    return float(np.sum(2 * half_angles) / (4 * np.pi))
