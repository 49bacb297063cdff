"""A convex part of a mesh: its hull, and a transform that makes it as round as possible."""

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
    """Transforms of rays to the unit frames of n convex parts, in Mitsuba's memory.

    In a part's unit frame, the unit sphere encloses the part. `maps` (n, 3, 4) are the affine maps
    from the world to the frames.
    """

    def __init__(self, maps: ArrayLike) -> None:
        self.rows = Rows(np.reshape(maps, (-1, 4)))

    def transform_ray(
        self, number: JitInt, ray: MitsubaObject, active: JitMask = True
    ) -> tuple[JitVector, JitVector]:
        """Return the origin and the direction of a ray in the unit frame of the part `number`.

        The direction is not normalised, so that distances along the ray stay the same.
        """
        import drjit as dr
        import mitsuba as mi

        rows = [self.rows.at(3 * number + k, mi.Vector4f, active) for k in range(3)]
        linear = [mi.Vector3f(row.x, row.y, row.z) for row in rows]
        origin = (dr.dot(a, ray.o) + row.w for a, row in zip(linear, rows, strict=True))
        return mi.Vector3f(*origin), mi.Vector3f(*(dr.dot(a, ray.d) for a in linear))


MIN_THICKNESS = 1e-4  # smallest volume / area of a hull, relative to its longest side


@dataclass(frozen=True)
class Hull:
    """A convex hull in the coordinates of its mesh, and its planes in a unit frame.

    `vertices` (n, 3) are the hull's corners. `to_unit` is the affine map (3, 4) from the mesh to
    the unit frame, whose origin is inside the hull, and whose unit sphere encloses it. `planes`
    (m, 4) are the faces in the unit frame: the normal n, which points out, and the distance d > 0
    from the origin, so that n·x ≤ d inside.
    """

    vertices: FloatArray
    to_unit: FloatArray
    planes: FloatArray

    @property
    def radius(self) -> float:
        """The distance of the farthest vertex from the hull's centre, in the mesh's coordinates."""
        centre = -np.linalg.solve(self.to_unit[:, :3], self.to_unit[:, 3])
        return float(np.linalg.norm(self.vertices - centre, axis=1).max())


def make_hull(points: ArrayLike) -> Hull | None:
    """Return the convex hull of `points` (n, 3), or None if they enclose no volume.

    The origin of its unit frame (see `Hull`) is the centre of volume. The frame is stretched so
    that the hull's variance is equal in all directions: the ends of a long part then have as many
    texels in a plane map as its middle. An affine map preserves planes and convexity.

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
    except (QhullError, ValueError):  # the points lie in a plane, or are fewer than four
        return None
    if solid.volume < MIN_THICKNESS * solid.area:
        return None
    centre, covariance = _compute_volume_moments(solid)
    vertices = solid.points[solid.vertices]
    stretch = np.linalg.inv(np.linalg.cholesky(covariance))
    stretch /= np.linalg.norm((vertices - centre) @ stretch.T, axis=1).max()
    return Hull(
        vertices=vertices * size + low,
        to_unit=np.column_stack([stretch / size, -stretch @ (centre + low / size)]),
        planes=_transform_planes(solid, stretch, centre),
    )


def _compute_volume_moments(solid: Any) -> tuple[FloatArray, FloatArray]:
    """Return the centre of volume (3,) and the covariance (3, 3) of a SciPy `ConvexHull`.

    Both are sums over tetrahedra between a point inside and each face.
    """
    inside = solid.points[solid.vertices].mean(axis=0)
    corners = solid.points[solid.simplices] - inside  # (faces, corners, xyz)
    volume = np.abs(np.linalg.det(corners))
    volume /= volume.sum()
    total = corners.sum(axis=1)
    mean = volume @ total / 4
    # A tetrahedron with the corners 0 and cᵢ has the mean x xᵀ of (Σ cᵢ cᵢᵀ + (Σ cᵢ)(Σ cᵢ)ᵀ) / 20
    squares = np.einsum("fci,fcj->fij", corners, corners) + total[:, :, None] * total[:, None, :]
    return inside + mean, np.einsum("f,fij->ij", volume, squares) / 20 - np.outer(mean, mean)


def _transform_planes(solid: Any, stretch: FloatArray, centre: FloatArray) -> FloatArray:
    """Return the planes (m, 4) of a SciPy `ConvexHull` in its unit frame, without duplicates.

    A point x has the coordinates `stretch` (3, 3) times x - `centre` (3,) in the unit frame, in
    which the unit sphere encloses the hull.
    """
    normals, offsets = solid.equations[:, :3], solid.equations[:, 3]  # n·x + offset ≤ 0 inside
    planes = np.column_stack([normals @ np.linalg.inv(stretch), -offsets - normals @ centre])
    planes /= np.linalg.norm(planes[:, :3], axis=1, keepdims=True)
    _, first = np.unique(planes.round(7), axis=0, return_index=True)
    return planes[np.sort(first)]
