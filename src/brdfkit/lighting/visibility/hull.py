"""A convex part of a mesh: the hull of points, in a frame that makes it as round as possible."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from brdfkit.core.array_types import (
    ArrayLike,
    FloatArray,
    JitInt,
    JitMask,
    JitVector,
    MitsubaObject,
)
from brdfkit.mitsuba_bridge.arrays import Rows


class Frames:
    """The frames of n parts, given by affine `maps` (n, 3, 4) from the world."""

    def __init__(self, maps: ArrayLike) -> None:
        self.rows = Rows(np.reshape(maps, (-1, 4)))

    def transform_ray(
        self, number: JitInt, ray: MitsubaObject, active: JitMask = True
    ) -> tuple[JitVector, JitVector]:
        """Return the origin and the direction of a ray in frame `number`.

        The direction is not normalised, so that distances along it are those along the ray.
        """
        import drjit as dr
        import mitsuba as mi

        rows = [self.rows.at(3 * number + k, mi.Vector4f, active) for k in range(3)]
        linear = [mi.Vector3f(row.x, row.y, row.z) for row in rows]
        origin = (dr.dot(a, ray.o) + row.w for a, row in zip(linear, rows, strict=True))
        return mi.Vector3f(*origin), mi.Vector3f(*(dr.dot(a, ray.d) for a in linear))


MIN_THICKNESS = 1e-4  # of a part over its longest extent; a thinner one encloses nothing


@dataclass(frozen=True)
class Hull:
    """The convex hull of points, and its planes in the unit frame.

    `vertices` (n, 3) are the corners, in the coordinates of the mesh. `to_unit` is the affine map
    (3, 4) from there to the unit frame, whose origin is inside the hull and whose unit sphere
    encloses it. `planes` (m, 4) hold the unit normal n of each face, which points out, and its
    distance d > 0 from the origin, both in the unit frame: n·x ≤ d inside.
    """

    vertices: FloatArray
    to_unit: FloatArray
    planes: FloatArray

    @property
    def radius(self) -> float:
        """The distance of the farthest vertex from the frame's origin, in the mesh's unit."""
        centre = -np.linalg.solve(self.to_unit[:, :3], self.to_unit[:, 3])
        return float(np.linalg.norm(self.vertices - centre, axis=1).max())


def make_hull(points: ArrayLike) -> Hull | None:
    """Return the `Hull` of `points` (n, 3), or None if they enclose no volume.

    The unit frame has its origin in the centre of volume, and is stretched so that the hull's
    extent is equal in all directions: a map of its faces by direction then has as many texels for
    the ends of a long part as for its middle. Any affine map keeps planes and convexity.

    >>> corners = np.array(np.meshgrid([0, 4], [0, 1], [0, 1])).reshape(3, -1).T
    >>> make_hull(corners).planes[:, 3].round(3).tolist()    # a cube, in its unit frame
    [0.577, 0.577, 0.577, 0.577, 0.577, 0.577]
    """
    from scipy.spatial import ConvexHull, QhullError

    points = np.asarray(points, float)
    low, high = points.min(axis=0), points.max(axis=0)
    size = np.max(high - low)
    try:
        solid = ConvexHull((points - low) / max(size, np.finfo(float).tiny))
    except (QhullError, ValueError):  # flat, or fewer than four points
        return None
    if solid.volume < MIN_THICKNESS * solid.area:
        return None
    centre, covariance = _moments(solid)
    vertices = solid.points[solid.vertices]
    stretch = np.linalg.inv(np.linalg.cholesky(covariance))
    stretch /= np.linalg.norm((vertices - centre) @ stretch.T, axis=1).max()
    return Hull(
        vertices=vertices * size + low,
        to_unit=np.column_stack([stretch / size, -stretch @ (centre + low / size)]),
        planes=_transform_planes(solid, stretch, centre),
    )


def _moments(solid: Any) -> tuple[FloatArray, FloatArray]:
    """Return the centre of volume (3,) and the covariance (3, 3) of a SciPy `ConvexHull`.

    Both are sums over the tetrahedra from a point inside to each face.
    """
    inside = solid.points[solid.vertices].mean(axis=0)
    corners = solid.points[solid.simplices] - inside  # (faces, 3 corners, 3)
    volume = np.abs(np.linalg.det(corners))
    volume /= volume.sum()
    total = corners.sum(axis=1)
    mean = volume @ total / 4
    # For a tetrahedron with a corner at 0: E[x xᵀ] = (Σ cᵢ cᵢᵀ + (Σ c)(Σ c)ᵀ) / 20
    squares = np.einsum("fci,fcj->fij", corners, corners) + total[:, :, None] * total[:, None, :]
    return inside + mean, np.einsum("f,fij->ij", volume, squares) / 20 - np.outer(mean, mean)


def _transform_planes(solid: Any, stretch: FloatArray, centre: FloatArray) -> FloatArray:
    """Return the planes (m, 4) of a SciPy `ConvexHull` in the unit frame, without duplicates."""
    normals, offsets = solid.equations[:, :3], solid.equations[:, 3]  # n·x + offset ≤ 0 inside
    planes = np.column_stack([normals @ np.linalg.inv(stretch), -offsets - normals @ centre])
    planes /= np.linalg.norm(planes[:, :3], axis=1, keepdims=True)
    _, first = np.unique(planes.round(7), axis=0, return_index=True)
    return planes[np.sort(first)]
