"""Makes the shadow volume of a mesh in a light: walls from its silhouette, and caps at both ends.

A face has four homogeneous corners; a triangle repeats its last corner. Seen from outside the
volume, the corners of all faces run the same way round.
"""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray, IntArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.projective.light import Light
from brdfkit.shadows.volumes.casters import CASTERS
from brdfkit.shadows.volumes.mesh import Mesh
from brdfkit.shadows.volumes.silhouettes import SILHOUETTES

BACK_CAPS = ("triangles", "fan")


@dataclass(frozen=True)
class Faces:
    """Faces of a shadow volume.

    corners : the four homogeneous corners of each face, (k, 4, 4).
    times : how often each face counts, (k,): walls of several triangles may coincide.
    """

    corners: AnyArray
    times: AnyArray

    @classmethod
    def join(cls, parts: Iterable["Faces"]) -> "Faces":
        """Return the faces of several collections as one collection."""
        parts = list(parts)
        return cls(
            np.concatenate([np.empty((0, 4, 4)), *(part.corners for part in parts)]),
            np.concatenate([np.empty(0, int), *(part.times for part in parts)]),
        )


@dataclass(frozen=True)
class Volume:
    """A shadow volume: its walls, the caps at the mesh (front), and those at the far end (back)."""

    walls: Faces
    front: Faces
    back: Faces


def make_shadow_volume(
    mesh: Mesh,
    light: Light,
    casters: str = "all",
    silhouettes: str = "edge_toggling",
    length: float = 0.0,
    back_cap: str = "triangles",
) -> Volume:
    """Make the shadow volume of a mesh in a light.

    casters : which triangles cast the shadow, a name in `CASTERS`.
    silhouettes : how the silhouette of these triangles is found, a name in `SILHOUETTES`.
    length : length of the walls [unit of length]; 0 makes them infinite.
    back_cap : how the far end is closed: by "triangles", the casting triangles moved there, or by a
        "fan" of triangles over the extruded silhouette.

    Raises `BrdfkitError` for a mesh that `casters`, `silhouettes` or `back_cap` does not support.
    """
    casts = CASTERS[casters](mesh, light)
    edges, times = SILHOUETTES[silhouettes](mesh, casts)
    near, far = to_homogeneous(mesh.points), extrude_points(mesh.points, light, length)
    first, last = edges.T
    walls = np.stack([near[last], near[first], far[first], far[last]], axis=1)
    cap = mesh.triangles[casts != 0]
    front = Faces(make_triangular_faces(near[cap]), casts[casts != 0])
    if light.is_directional and not length:
        back = Faces.join([])  # all walls meet in one point at infinity, so nothing is open
    elif back_cap == "fan":
        require_triangles_on_one_side(mesh, light, cap)
        back = Faces(make_fan_faces(far[first], far[last]), times)
    else:
        back = Faces(make_triangular_faces(far[cap[:, ::-1]]), casts[casts != 0])
    return Volume(Faces(walls, times), front, back)


def extrude_points(points: FloatArray, light: Light, length: float) -> FloatArray:
    """Return points (n, 3), moved away from a light, as homogeneous points (n, 4).

    length : how far each point is moved [unit of length]; 0 moves it to infinity.
    """
    away = points * light.point[3] - light.point[:3]
    if not length:
        return np.column_stack([away, np.zeros(len(points))])
    away /= np.linalg.norm(away, axis=1, keepdims=True)
    return to_homogeneous(points + length * away)


def to_homogeneous(points: FloatArray) -> FloatArray:
    """Return finite points (n, 3) as homogeneous points (n, 4)."""
    return np.column_stack([points, np.ones(len(points))])


def make_triangular_faces(corners: FloatArray) -> FloatArray:
    """Return triangles (k, 3, 4) as faces (k, 4, 4), each with its last corner repeated."""
    return corners[:, [0, 1, 2, 2]]


def make_fan_faces(first: FloatArray, last: FloatArray) -> FloatArray:
    """Return triangles from the middle of a silhouette to each of its edges, as faces (k, 4, 4).

    first, last : homogeneous ends (k, 4) of the edges.
    """
    middle = np.vstack([first, last]).mean(axis=0) if len(first) else np.zeros(4)
    return make_triangular_faces(
        np.stack([np.broadcast_to(middle, first.shape), last, first], axis=1)
    )


def require_triangles_on_one_side(mesh: Mesh, light: Light, cap: IntArray) -> None:
    """Raise `BrdfkitError` if the triangles `cap` of a mesh surround a point or spot light.

    cap : indices (k, 3) of the triangles' corners.
    """
    away = mesh.points[np.unique(cap)] - light.point[:3]
    if not light.is_directional and np.any(away @ away.mean(axis=0) <= 0):
        raise BrdfkitError(
            f"{mesh.name}: the shape surrounds the light, so that no fan closes its shadow "
            "volume; use back_cap = triangles."
        )
