"""Convex bodies, by corners and planes, that bound the space which a shadow map must cover."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from brdfkit.core.array_types import AnyArray, ArrayLike, FloatArray
from brdfkit.core.errors import BrdfkitError

LEAST_RADIUS = 1e-9  # if a body of size 1 holds no ball of this radius, it is flat


class Empty(BrdfkitError):
    """The error where nothing that the camera sees is in the light, so that no shadow shows."""


@dataclass(frozen=True)
class Body:
    """A convex body, given twice: by its corners (n, 3), and by the planes (m, 4) of its faces.

    A plane is a vector a (3,) and a number d; points x inside the body have a·x + d ≤ 0.
    """

    corners: np.ndarray
    planes: np.ndarray

    @classmethod
    def from_points(cls, points: ArrayLike) -> Body:
        """Return the convex hull of points (n, 3).

        Raises `Empty` where they enclose no volume.
        """
        from scipy.spatial import ConvexHull, QhullError

        points = np.asarray(points, float)
        try:
            hull = ConvexHull(points)
        except (QhullError, ValueError) as error:
            raise Empty("the part of the scene to be shadowed has no volume.") from error
        return cls(points[hull.vertices], hull.equations)

    @cached_property
    def centroid(self) -> FloatArray:
        """The centroid (3,) of the volume, which moves without jumps when the body does."""
        from scipy.spatial import ConvexHull

        inside = self.corners.mean(axis=0)
        sides = self.corners[ConvexHull(self.corners).simplices] - inside
        volumes = np.abs(np.linalg.det(sides))
        return inside + volumes @ sides.sum(axis=1) / (4 * volumes.sum())

    def __and__(self, other: Body) -> Body:
        """Return the intersection of two bodies; raise `Empty` where it has no volume."""
        from scipy.spatial import HalfspaceIntersection

        # The planes are scaled to those of a body of size 1, which suits the solvers' tolerances
        middle, size = self.corners.mean(axis=0), np.ptp(self.corners, axis=0).max()
        planes = np.vstack([self.planes, other.planes])
        planes[:, 3] = (planes[:, :3] @ middle + planes[:, 3]) / size
        inside = _find_inscribed_centre(planes)
        if inside is None:
            raise Empty("no part of the scene is before the camera and in the light.")
        corners = HalfspaceIntersection(planes, inside).intersections
        return Body.from_points(middle + size * corners)

    def extend_to_light(self, light: FloatArray, length: float) -> Body:
        """Return the body extended by `length` or more towards a light, to hold what may shadow it.

        light : (4,), homogeneous: a position with w = 1, or the direction to the light with w = 0.
        """
        to_light = light[:3] - light[3] * self.corners
        share = 2 * length / max(np.linalg.norm(to_light, axis=1).min(), 1e-30)
        # The body ends at the light or before it, as convex hulls of long needles are inexact
        share = share if light[3] == 0 else min(share, 1)
        return Body.from_points(np.vstack([self.corners, self.corners + share * to_light]))


def make_box(low: ArrayLike, high: ArrayLike) -> Body:
    """Return the box from `low` to `high` (3,) as a body; a flat box becomes a little thicker."""
    low, high = np.asarray(low, float), np.asarray(high, float)
    least = 1e-4 * max((high - low).max(), 1e-30)
    grown = np.maximum(least - (high - low), 0) / 2
    x, y, z = np.stack([low - grown, high + grown], axis=1)
    return Body.from_points([[x[i], y[j], z[k]] for i, j, k in np.ndindex(2, 2, 2)])


def _find_inscribed_centre(planes: AnyArray) -> FloatArray | None:
    """Return the centre (3,) of the largest ball in a body of size 1, given by `planes` (m, 4).

    Return None where the planes enclose no volume.
    """
    from scipy.optimize import linprog

    # Find the centre x and the largest radius r for which the ball lies within each plane (a, d),
    # that is a·x + |a| r ≤ -d
    norms = np.linalg.norm(planes[:, :3], axis=1)
    system = np.column_stack([planes[:, :3], norms])
    bounds = [(None, None)] * 3 + [(0, None)]
    solution = linprog([0, 0, 0, -1], system, -planes[:, 3], bounds=bounds)
    return solution.x[:3] if solution.success and solution.x[3] > LEAST_RADIUS else None
