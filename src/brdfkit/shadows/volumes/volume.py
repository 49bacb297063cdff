"""The shadow volume of a mesh in a light: walls from its silhouette, and caps that close it.

A face has four corners, homogeneous points in their turn; those of a triangle name the last twice.
Seen from without the corners of all faces run the same way round.
"""

from dataclasses import dataclass

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.shadows.volumes.casters import CASTERS
from brdfkit.shadows.volumes.silhouettes import SILHOUETTES


def extruded(points, light, length):
    """The points (n, 4) of `points` (n, 3), away from a `Light`.

    length : how far each is moved [unit of length]; 0: to infinity.
    """
    away = points * light.point[3] - light.point[:3]
    if not length:
        return np.column_stack([away, np.zeros(len(points))])
    away /= np.linalg.norm(away, axis=1, keepdims=True)
    return finite(points + length * away)


def finite(points):
    """Points (n, 3) at a place, as (n, 4)."""
    return np.column_stack([points, np.ones(len(points))])


BACK_CAPS = ("triangles", "fan")


@dataclass(frozen=True)
class Faces:
    """Faces by their `corners` (k, 4, 4), and how often each of them counts (k,)."""

    corners: np.ndarray
    times: np.ndarray

    def __len__(self):
        return len(self.times)

    @classmethod
    def joined(cls, parts):
        """All faces of several."""
        return cls(
            np.concatenate([np.empty((0, 4, 4)), *(part.corners for part in parts)]),
            np.concatenate([np.empty(0, int), *(part.times for part in parts)]),
        )


@dataclass(frozen=True)
class Volume:
    """The `walls`, and the caps at the object (`front`) and at the far end (`back`): `Faces`."""

    walls: Faces
    front: Faces
    back: Faces


def shadow_volume(
    mesh, light, casters="all", silhouettes="edge_toggling", length=0.0, back_cap="triangles"
):
    """The `Volume` of a `Mesh` in a `Light`.

    casters : which triangles cast, of `CASTERS`.
    silhouettes : how their silhouette is found, of `SILHOUETTES`.
    length : of the walls [unit of length]; 0: without an end.
    back_cap : the same triangles extruded, or a fan over the extruded silhouette.

    Raises `BrdfkitError` for a mesh that the way to its silhouette does not take.
    """
    casts = CASTERS[casters](mesh, light)
    edges, times = SILHOUETTES[silhouettes](mesh, casts)
    near, far = finite(mesh.points), extruded(mesh.points, light, length)
    first, last = edges.T
    walls = np.stack([near[last], near[first], far[first], far[last]], axis=1)
    cap = mesh.triangles[casts != 0]
    front = Faces(triangle(near[cap]), casts[casts != 0])
    if light.is_directional and not length:
        back = Faces.joined([])  # all its corners are one point
    elif back_cap == "fan":
        require_on_one_side(mesh, light, cap)
        back = Faces(fan(far[first], far[last]), times)
    else:
        back = Faces(triangle(far[cap[:, ::-1]]), casts[casts != 0])
    return Volume(Faces(walls, times), front, back)


def triangle(corners):
    """Triangles (k, 3, 4) as faces (k, 4, 4)."""
    return corners[:, [0, 1, 2, 2]]


def fan(first, last):
    """Triangles from the middle of a silhouette to each of its edges, `first` (k, 4) to `last`."""
    middle = np.vstack([first, last]).mean(axis=0) if len(first) else np.zeros(4)
    return triangle(np.stack([np.broadcast_to(middle, first.shape), last, first], axis=1))


def require_on_one_side(mesh, light, cap):
    """Raise `BrdfkitError` where the triangles `cap` (k, 3) are all around a light at a place."""
    away = mesh.points[np.unique(cap)] - light.point[:3]
    if not light.is_directional and np.any(away @ away.mean(axis=0) <= 0):
        raise BrdfkitError(
            f"{mesh.name}: the shape is all around the light, where no fan closes its shadow "
            "volume; use back_cap = triangles."
        )
